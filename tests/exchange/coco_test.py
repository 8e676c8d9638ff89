"""`isoline export` writes what other programs read: COCO's post-processing, whose rules are written
here a second time, by its documentation and its files, and CSV with the numbers of the records."""

import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

HEADER = re.compile(r"funcId = (\d+), DIM = (\d+), Precision = (\d\.\d{3}e-\d\d), algId = '([^']+)'")
DATA = re.compile(r"[\w./-]+\.dat((?:, \d+:\d+\|-?\d\.\de[+-]\d+)+)")
BLOCK = re.compile(r"% function evaluation \| noise-free fitness - Fopt \((-?\d\.\d+e[+-]\d+)\) \| ")


def entries(index):
    """The entries of an index file: a header, a comment, a line of data, each as the format has it."""
    lines = index.read_text().splitlines()
    assert len(lines) % 3 == 0, f"{index}: {len(lines)} lines are no triples"
    for header, comment, data in zip(*[iter(lines)] * 3):
        told, named = HEADER.fullmatch(header), DATA.fullmatch(data)
        assert told and named and comment.startswith("%"), f"{index}: {header} {comment} {data}"
        file, *runs = data.split(", ")
        instances = []
        for run in runs:
            number, rest = run.split(":")
            evaluations, final = rest.split("|")
            instances.append((int(number), int(evaluations), float(final)))
        yield int(told[1]), int(told[2]), told[4], index.parent / file, instances


def blocks(table):
    """The runs of a table: f_opt, and rows of five numbers."""
    runs = []
    for line in table.read_text().splitlines():
        if line.startswith("%"):
            begun = BLOCK.match(line)
            assert begun, f"{table}: {line}"
            runs.append((float(begun[1]), []))
            continue
        evaluations, *values = line.split(" ")
        row = [int(evaluations), *map(float, values)]
        assert len(row) == 5 and all(map(math.isfinite, row)), f"{table}: {line}"
        runs[-1][1].append(row)
    return runs


class Coco(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.place = tempfile.TemporaryDirectory()
        here = pathlib.Path(cls.place.name)
        cls.results, cls.data = here / "results", here / "data"
        isoline = sys.argv[1]
        ran = subprocess.run(
            [isoline, "run", "--problem", "rosenbrock,square,beale", "--optimizer",
             "gd,gauss-newton,newton,adam[rate=0.1]", "--seeds", "3", "--iterations", "300", "--rates",
             "none", "--out", cls.results, "--quiet", "--no-report"], capture_output=True, text=True, check=False)
        assert ran.returncode in (0, 2), ran.stderr
        cls.told = subprocess.run(
            [isoline, "export", cls.results, "--format", "coco", "--out", cls.data],
            capture_output=True, text=True, check=True)
        cls.curves = here / "curves.csv"
        subprocess.run([isoline, "export", cls.results, "--out", cls.curves], capture_output=True, check=True)
        cls.records = [json.loads(file.read_text()) for file in (cls.results / "runs").glob("*.json")]
        with open(cls.data / "functions.csv", newline="", encoding="utf-8") as functions:
            cls.functions = {int(row["funcId"]): row for row in csv.DictReader(functions)}

    @classmethod
    def tearDownClass(cls):
        cls.place.cleanup()

    def test_a_table_has_a_row_per_run_with_the_work_to_each_tolerance(self):
        table = pathlib.Path(self.place.name) / "runs.csv"
        subprocess.run([sys.argv[1], "export", self.results, "--format", "runs", "--out", table],
                       capture_output=True, check=True)
        with open(table, newline="", encoding="utf-8") as file:
            rows = {row["cell"]: row for row in csv.DictReader(file)}
        self.assertEqual(rows.keys(), {record["cell"] for record in self.records})
        for record in self.records:
            row, loss = rows[record["cell"]], record["summary"]["loss"]
            judged = record["found" if record["aim"] == "x" else "verified"]
            self.assertEqual(float(row["loss"]), float(loss))
            met = [float(row[f"work_to_{tau}"]) for tau in ("1e-1", "1e-3", "1e-6")]
            self.assertEqual(met, sorted(met))
            for tau, work in zip(("1e-1", "1e-3", "1e-6"), met):
                self.assertEqual(judged.get(tau) is True, work < math.inf, row)

    def test_pandas_reads_the_same_bits_with_its_option(self):
        """As docs/exchanging-results.md says."""
        try:
            import pandas
        except ImportError:
            self.skipTest("pandas is not installed")
        read = pandas.read_csv(self.curves, float_precision="round_trip")["loss"].dropna().tolist()
        with open(self.curves, newline="", encoding="utf-8") as file:
            written = [row["loss"] for row in csv.DictReader(file)]
        self.assertEqual(read, [float(loss) for loss in written if loss not in ("", "nan")])
        kept = {float(loss) for record in self.records for loss in record["curve"]["loss"]}
        self.assertGreater(len(read), 1000)
        self.assertLessEqual(set(read), kept)

    def indices(self):
        found = sorted(self.data.glob("*/*.info"))
        self.assertGreaterEqual(len(found), 10)
        return found

    def runs(self):
        """Each run of the export with its record."""
        for index in self.indices():
            for function, dimension, method, table, instances in entries(index):
                by_target, by_evaluation = blocks(table), blocks(table.with_suffix(".tdat"))
                self.assertEqual(len(by_target), len(instances))
                self.assertEqual(len(by_evaluation), len(instances))
                for instance, dat, tdat in zip(instances, by_target, by_evaluation):
                    found = [record for record in self.records
                             if record["request"]["problem"]["spec"] == self.functions[function]["problem"]
                             and record["request"]["optimizer"]["spec"] == method
                             and record["request"]["seed"] == instance[0] - 1]
                    self.assertEqual(len(found), 1, f"{method}, f{function}, {instance}")
                    self.assertEqual(dimension, int(self.functions[function]["DIM"]))
                    yield instance, dat, tdat, found[0]

    def test_every_run_that_was_measured_is_there_once(self):
        measured = [record for record in self.records
                    if record["status"] != "inapplicable" and
                    any(isinstance(loss, (int, float)) for loss in record["curve"]["loss"])]
        self.assertEqual(len(list(self.runs())), len(measured))

    def test_evaluations_rise_and_the_best_only_falls(self):
        for _, dat, tdat, record in self.runs():
            for minimum, rows in (dat, tdat):
                self.assertGreater(len(rows), 0)
                self.assertGreaterEqual(rows[0][0], 1)
                self.assertAlmostEqual(minimum, record["minimum"], delta=1e-9 * abs(minimum) + 1e-12)
                for before, after in zip(rows, rows[1:]):
                    self.assertLess(before[0], after[0])
                    self.assertLessEqual(after[2], before[2])
                for row in rows:
                    self.assertLessEqual(row[2], row[1])
            best = [row[2] for row in dat[1]]
            self.assertEqual(best, sorted(set(best), reverse=True), "a row a new best")

    def test_the_tables_are_the_curves_of_the_records(self):
        for _, _, (_, rows), record in self.runs():
            losses = {}
            for work, loss in zip(record["curve"]["work"], record["curve"]["loss"]):
                if isinstance(loss, (int, float)):
                    losses[work + 1] = loss - record["minimum"]
            self.assertEqual([row[0] for row in rows], sorted(losses))
            for row in rows:
                self.assertAlmostEqual(row[1], losses[row[0]], delta=1e-8 * abs(losses[row[0]]))

    def test_a_target_is_met_by_the_evaluation_that_the_record_tells(self):
        seen = 0
        for _, (_, rows), _, record in self.runs():
            scale = min(record["scale"], record["summary"]["start_loss"] - record["minimum"])
            for target, work in zip(record["hits"]["target"], record["hits"]["work"]):
                first = next((row[0] for row in rows if row[2] <= target * scale), None)
                self.assertEqual(first, None if work < 0 else work + 1)
                seen += work >= 0
        self.assertGreater(seen, 500)

    def test_the_index_tells_the_last_evaluation_and_the_best_loss(self):
        for (_, evaluations, final), dat, tdat, _ in self.runs():
            self.assertEqual(evaluations, max(dat[1][-1][0], tdat[1][-1][0]))
            self.assertAlmostEqual(final, dat[1][-1][2], delta=0.06 * abs(final))

    def test_a_row_of_csv_has_the_numbers_of_its_point_to_the_bit(self):
        with open(self.curves, newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), sum(len(record["curve"]["work"]) or 1 for record in self.records))
        points = {}
        for row in rows:
            points.setdefault((row["cell"], row["build"]), []).append(row)
        for record in self.records:
            found, curve = points[record["cell"], record["build"]], record["curve"]
            for row in found:
                self.assertEqual(row["optimizer"], record["request"]["optimizer"]["spec"])
                self.assertEqual(row["imported"], "false")
            for name in ("loss", "x_error", "gradient_norm", "wall_seconds"):
                self.assertEqual([repr(float(row[name])) for row in found if row[name] != ""],
                                 [repr(float(value)) for value in curve[name]])
            self.assertEqual([int(row["forward"]) for row in found if row["forward"] != ""],
                             curve["counts"].get("forward", [0] * len(curve["work"])))

    def test_a_second_export_into_the_same_folder_is_refused(self):
        again = subprocess.run([sys.argv[1], "export", self.results, "--format", "coco", "--out",
                                self.data], capture_output=True, text=True, check=False)
        self.assertEqual(again.returncode, 1)
        self.assertIn("exists already", again.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
