"""A curve of others becomes a record that is marked as theirs; a damaged one is refused in one
sentence with its line. import_test.py ISOLINE CLIENTS"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

CURVE = "iter,f,nfev\n0,24.2,1\n1,4,3\n2,1e-6,5\n3,0,7\n"

DAMAGES = [
    ("", "is empty"),
    ("\n\n", "is empty"),
    ("f,nfev\n", "no row"),
    ("f,nfev\n1,2\n3\n", "line 3: expected 2 fields"),
    ("f,nfev\n1,2\n3,4,5\n", "line 3: expected 2 fields"),
    ("f,nfev\n1,2\n\n\nx,4\n", "line 5: loss is not"),
    ("f,nfev\n1,2\n,4\n", "line 3: loss is missing"),
    ("f,nfev\n1,2.5\n", "line 2: forward must be"),
    ("f,nfev\n1,-2\n", "line 2: forward must be"),
    ("f,nfev\n1,\n", "line 2: forward must be"),
    ("f,nfev\n1,1e300\n", "line 2: forward must be"),
    ("f,nfev\n1,4\n1,3\n", "line 3: forward must not"),
    ("g,nfev\n1,4\n", "line 1: no column"),
    ("f,f,nfev\n1,1,4\n", "line 1: two columns"),
    ("1,4\n1,5\n", "line 1: the file"),
    ("f,nfev\n\"1,4\n", "line 2: "),
    ("f,nfev\n1\"2,4\n", "line 2: loss is not"),
    ("f,nfev\n\"1\"x,4\n", "line 2: "),
    ("f,nfev\n1,\0004\n", "line 2: a zero byte"),
    ("f,nfev\n" + "x" * 1_000_000 + ",4\n", "line 2: "),
    (b"f,nfev\xa0\n1,4\n", "is not text in UTF-8"),
]


def description(columns=None, **members):
    return {"schema": "isoline.import/1", "problem": "rosenbrock", "optimizer": "their-lm", "seed": 0,
            "source": "Table 2", "date": "2026-01-31",
            "columns": columns or {"loss": "f", "forward": "nfev"}, **members}


class Import(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        cls.isoline("run", "--problem", "rosenbrock", "--optimizer", "gd", "--iterations", "5",
                    "--out", "results", "--no-report", "--quiet")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def isoline(cls, *words):
        return subprocess.run([ISOLINE, *words], cwd=cls.folder, capture_output=True, text=True,
                              check=True, timeout=120)

    def script(self, curve, told):
        (self.folder / "theirs.csv").write_bytes(
            curve if isinstance(curve, bytes) else curve.encode())
        (self.folder / "theirs.json").write_text(json.dumps(told))
        return subprocess.run([sys.executable, CLIENTS / "import_curve.py", "theirs.csv", "--out",
                               "results"], cwd=self.folder, capture_output=True, text=True, timeout=120)

    def imported(self, curve=CURVE, told=None):
        run = self.script(curve, told or description())
        self.assertEqual(run.returncode, 0, run.stderr)
        file = self.folder / run.stdout.splitlines()[-1].split(":")[0]
        record = json.loads(file.read_text())
        record["file"] = file
        return record

    def refusal(self, curve=CURVE, **members):
        run = self.script(curve, {**description(), **members})
        self.assertEqual(run.returncode, 1, run.stdout)
        return run.stderr.strip()

    def test_it_makes_a_record_that_conforms_and_is_marked(self):
        record = self.imported()
        self.assertEqual(record["imported"]["source"], "Table 2")
        self.assertEqual(set(record["verified"].values()), {None})
        self.isoline("validate", "results")  # the schema, and that the cell is the request's digest

    def test_the_same_files_give_the_same_record_and_others_another(self):
        first = self.imported()
        self.assertEqual(first, self.imported())
        self.assertNotEqual(first["build"], self.imported(CURVE + "4,0,9\n")["build"])
        self.assertEqual(first["cell"], self.imported(CURVE + "\n")["cell"])

    def test_on_a_problem_of_ours_its_targets_measure_the_curve(self):
        # Of rosenbrock f_L = 0 and s = 12.1, half of its f0: as records of ours have it.
        record = self.imported()
        self.assertEqual(record["minimum"], 0)
        self.assertAlmostEqual(record["scale"], 12.1)
        self.assertEqual(record["hits"]["work"][0], 3, "24.2 is more than s")
        self.assertEqual(record["hits"]["work"][5], 5, "4 exceeds s/10")
        self.assertEqual(record["hits"]["iteration"][50], 3)
        self.assertIn("remove minimum", self.refusal(minimum=-1))
        self.assertIn("rosenbrock with seed 9", self.refusal(seed=9))

    def test_on_a_problem_of_others_what_they_say_measures_it(self):
        told = description(problem="their-bridge[span=30]")
        self.assertNotIn("hits", self.imported(told=told), "no least loss is known")
        record = self.imported(told={**told, "minimum": 0, "scale": 1})
        self.assertEqual(record["scale"], 1)
        self.assertEqual(record["hits"]["work"][0], 5)
        self.isoline("validate", "results")

    def test_files_are_taken_as_they_come_from_other_systems(self):
        plain = self.imported()["curve"]["loss"]
        for other in [b"\xef\xbb\xbf" + CURVE.replace("\n", "\r\n").encode(),
                      '"iter", "f" ,"nfev"\n0, 24.2 ,1\n1,+4,3\n2,"1e-6",5\n3,0,7']:
            self.assertEqual(self.imported(other)["curve"]["loss"], plain)
        by_place = description({"loss": 2, "forward": 3})
        self.assertEqual(self.imported(CURVE.split("\n", 1)[1], by_place)["curve"]["loss"], plain)

    def test_separators_and_exponents_are_those_of_other_programs(self):
        plain = self.imported()["curve"]["loss"]
        for separator in ";\t":
            other = CURVE.replace(",", separator).replace("24.2", "2.42D+01")
            self.assertEqual(self.imported(other)["curve"]["loss"], plain)

    def test_a_loss_below_the_least_attainable_one_is_refused(self):
        self.assertIn("work 3", self.refusal("f,nfev\n24.2,1\n-1,3\n"))
        told = {"problem": "their-bridge[span=30]", "minimum": 2}
        self.assertIn("point 2", self.refusal("f,nfev\n24.2,1\n1.9,3\n", **told))
        self.imported("f,nfev\n24.2,1\n-1e-15,3\n")  # rounding

    def test_what_is_not_finite_is_kept(self):
        record = self.imported("f,nfev\n3,1\nNaN,2\ninf,3\n-Infinity,4\nnan,5\n")
        self.assertEqual(record["curve"]["loss"][1:4], ["nan", "inf", "-inf"])
        self.assertEqual(record["status"], "diverged")

    def test_a_million_rows_are_thinned_and_no_target_is_missed(self):
        rows = "".join(f"{1 if i < 654_321 else 0},{i}\n" for i in range(1_000_000))
        record = self.imported("f,nfev\n" + rows)
        self.assertLess(len(record["curve"]["loss"]), 300)
        self.assertEqual(record["curve"]["iteration"][-1], 999_999)
        self.assertEqual(record["hits"]["iteration"][50], 654_321)
        record["file"].unlink()

    def test_a_curve_keeps_the_iterations_that_the_meter_keeps(self):
        self.isoline("run", "--problem", "rosenbrock", "--optimizer", "gd[rate=1e-9]", "--iterations",
                     "20000", "--out", "long", "--no-report", "--quiet")
        ours = json.loads(next((self.folder / "long/runs").glob("*.json")).read_text())
        rows = "".join(f"1,{i}\n" for i in range(20_001))
        self.assertEqual(self.imported("f,nfev\n" + rows)["curve"]["iteration"],
                         ours["curve"]["iteration"])

    def test_a_damaged_file_is_one_sentence_with_its_line(self):
        for curve, sentence in DAMAGES:
            told = self.refusal(curve)
            self.assertIn(sentence, told)
            self.assertTrue(told.startswith("import_curve: theirs.csv"), told)
            self.assertNotIn("\n", told)
            self.assertLess(len(told), 300)

    def test_iterations_rise_by_their_own_column(self):
        columns = {"loss": "f", "forward": "n", "iteration": "i"}
        self.assertIn("line 3: iteration 0 occurs twice",
                      self.refusal("i,f,n\n0,1,1\n0,1,2\n", columns=columns))
        self.assertIn("line 3: iteration",
                      self.refusal("i,f,n\n5,1,1\n4,1,2\n", columns=columns))

    def test_a_description_is_validated(self):
        loss = {"loss": "f"}
        for members, sentence in [
                ({"optimizer": "gd"}, "gd is an optimizer"),
                ({"date": "31 January"}, "date must be"), ({"date": "2026-02-31"}, "date must be"),
                ({"problem": "sine[xi"}, ".json: problem: 'sine[xi' is not"),
                ({"columns": loss}, "columns must contain"),
                ({"columns": {**loss, "jacobian": "nfev"}}, "depends on the problem"),
                ({"columns": {**loss, "work": 9}}, "must be in column 9"),
                ({"columns": {**loss, "work": 0}}, "columns: work must be"),
                ({"seed": -1}, "seed must be"), ({"source": ""}, "source is missing"),
                ({"source": "\0"}, "source has a zero"),
                ({"colour": "red"}, "unknown member colour"), ({"status": "solved"}, "status must be"),
                ({"schema": "isoline.import/2"}, "schema must be")]:
            self.assertIn(sentence, self.refusal(**members))


if __name__ == "__main__":
    ISOLINE, CLIENTS = sys.argv[1], pathlib.Path(sys.argv[2])
    unittest.main(argv=sys.argv[:1])
