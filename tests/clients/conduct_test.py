"""The columns of the raw table of conduct: methods that are wrong on purpose, and one whose cells are known."""

import contextlib
import io
import json
import pathlib
import runpy
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "clients" / "peers" / "conduct"
sys.path.insert(0, str(FOLDER))

try:
    import numpy

    import conduct
    import methods
except ImportError as error:
    print(f"this test needs NumPy: {error}", file=sys.stderr)
    sys.exit(77)

TABLE = ROOT / "clients" / "peers" / "conduct" / "conduct.json"
PAGE = ROOT / "docs" / "conduct.md"
peers = runpy.run_path(str(ROOT / "docs" / "peers.py"))


def right(p, limit, _=None):
    """Gauss-Newton with halved steps, which keeps bounds, its limit and its best point."""
    low, high = p.bounds or (numpy.full(p.n, -numpy.inf), numpy.full(p.n, numpy.inf))
    x, calls, most = p.start, 1, limit or 500
    r = p.residual(x)
    while calls < most:
        J = p.jacobian(x)
        slope = J.T @ r
        free = ~(((x <= low) & (slope > 0)) | ((x >= high) & (slope < 0)))
        step = numpy.zeros(p.n)
        step[free] = numpy.linalg.lstsq(J[:, free], -r, rcond=None)[0]
        if (abs(step) <= 1e-7 * numpy.maximum(abs(x), 1e-6)).all():
            return methods.Outcome(x, True, "solved", calls)
        share = 1.0
        while calls < most:
            ahead = numpy.clip(x + share * step, low, high)
            there = p.residual(ahead)
            calls += 1
            if there @ there < r @ r:
                x, r = ahead, there
                break
            share /= 2
            if share < 1e-12:
                return methods.Outcome(x, False, "no step", calls)
    return methods.Outcome(x, False, "limit", calls)


def counts_too_few(p, limit, _=None):
    found = right(p, limit)
    found.own -= 1
    return found


def exceeds_its_limit(p, limit, _=None):
    return right(p, limit and limit + 3)


def returns_another_point(p, limit, _=None):
    found = right(p, limit)
    found.x = found.x * (1 + 1e-9)
    return found


def works_at_the_solution(p, limit, _=None):
    for _ in range(40):
        p.residual(p.start)
    found = right(p, limit)
    found.own += 40
    return found


def ends_without_a_value(p, limit, _=None):
    if p.n > 1:
        return right(p, limit)
    p.residual(numpy.array([-6.0]))
    return methods.Outcome(numpy.array([-6.0]), True, "solved", 1)


def claims_at_once(p, limit, _=None):
    p.residual(p.start)
    return methods.Outcome(p.start, True, "solved", 1)


def leaves_bounds(p, limit, _=None):
    if p.bounds:
        p.residual(p.bounds[1] + 1e-8)
    return right(p, limit)


def depends_on_scale(p, limit, _=None):
    if p.start[1:2].tolist() == [1e6]:
        p.residual(p.start), p.residual(p.start), p.residual(p.start)
    return right(p, limit)


def pays_for_bounds(p, limit, _=None):
    return (works_at_the_solution if p.bounds else right)(p, limit)


runs_before = []


def remembers(p, limit, _=None):
    if runs_before:
        p.residual(p.start)
    runs_before.append(1)
    return right(p, limit)


def talks(p, limit, _=None):
    print("iteration 1")
    return right(p, limit)


WRONG = {
    "own counter": counts_too_few, "beyond a budget": exceeds_its_limit, "returned point": returns_another_point,
    "started at the solution": works_at_the_solution, "trial without a value": ends_without_a_value,
    "claims success": claims_at_once, "outside the bounds": leaves_bounds, "scales": depends_on_scale,
    "loose bound": pays_for_bounds, "second run": remembers, "text": talks,
}


# Columns that no last bit of a sum decides.
STEADY = ("own counter", "beyond a budget", "started at the solution", "trial without a value", "outside the bounds", "text")


def row(run):
    method = methods.Method("ours", "none", run, "residuals", keeps_bounds=True)
    with contextlib.redirect_stderr(io.StringIO()):
        return conduct.row_of(method)[0]


class Conduct(unittest.TestCase):
    def setUp(self):
        conduct.FEW = conduct.MANY = 2  # for the time that they take

    def test_a_method_that_is_right_has_no_cross(self):
        self.assertEqual({name: cell for name, cell in row(right).items() if cell["mark"] == "✗"}, {})

    def test_each_column_sees_a_method_that_is_wrong_there(self):
        self.assertEqual(WRONG.keys(), conduct.COLUMNS.keys())
        for name, run in WRONG.items():
            self.assertEqual(row(run)[name]["mark"], "✗", name)

    def test_a_run_that_does_not_end_is_named(self):
        def endless(p, limit, _=None):
            while True:
                p.residual(p.start)

        cell = row(endless)["trial without a value"]
        self.assertEqual((cell["mark"], cell["figures"]), ("✗", "without end"))

    def test_a_process_that_crashes_has_no_count(self):
        cells = row(lambda *_: conduct.os.abort())
        self.assertEqual((cells["own counter"]["mark"], cells["own counter"]["figures"]), ("–", "crashed"))
        self.assertEqual(cells["trial without a value"]["mark"], "✗")

    def test_each_cell_names_the_records_of_its_runs(self):
        table = json.loads(TABLE.read_text())
        for name, cells in table["methods"].items():
            for column, cell in cells.items():
                self.assertLessEqual(set(cell["runs"]), set(table["runs"][name]), f"{name}: {column}")
                if cell["mark"] != "–" and column != "second run":
                    self.assertTrue(cell["runs"], f"{name}: {column}")

    def test_the_published_cells_follow_from_the_published_runs(self):
        table = json.loads(TABLE.read_text())
        for name, cells in table["methods"].items():
            runs = table["runs"][name]
            count = runs["E3"]
            if count.get("own") is not None:
                self.assertEqual(cells["own counter"]["mark"], "✓" if count["own"] == count["calls"] else "✗", name)
            ends = [runs[each] for each in cells["returned point"]["runs"]]
            if all("lost" not in each for each in ends):
                are_best = all(each["evaluated"] and each["loss"] <= each["best"] for each in ends)
                self.assertEqual(cells["returned point"]["mark"], "✓" if are_best else "✗", name)
            self.assertEqual(cells["text"]["mark"], "✗" if count["bytes"] else "✓", name)

    def test_what_is_published_is_what_scipy_does(self):
        table = json.loads(TABLE.read_text())
        try:
            import scipy
        except ImportError:
            self.skipTest("SciPy is not installed")
        if not table["packages"]["python3-scipy"].startswith(scipy.__version__):
            self.skipTest(f"the table is of SciPy {table['packages']['python3-scipy']}")
        for method in (each for each in methods.ALL if each.name.startswith("SciPy ")):
            runs = conduct.Runs(method)
            for name in STEADY:
                try:
                    holds, _ = conduct.COLUMNS[name](runs)
                except conduct.Lost:
                    holds = False
                published = table["methods"][method.name][name]["mark"]
                self.assertEqual({None: "–", True: "✓", False: "✗"}[holds], published, f"{method.name}: {name}")

    def unchanged(self, page, write):
        with tempfile.NamedTemporaryFile("w", suffix=".md") as copy:
            copy.write(page.read_text())
            copy.flush()
            write(copy.name)
            self.assertEqual(pathlib.Path(copy.name).read_text(), page.read_text())

    def test_the_page_shows_the_published_table(self):
        self.unchanged(PAGE, lambda copy: conduct.page(TABLE, copy))

    def test_the_page_of_peers_shows_their_rows(self):
        self.unchanged(PAGE.with_name("bring-an-optimizer.md"), peers["page"])

    def test_the_page_shows_the_published_table_of_our_own_methods(self):
        own = json.loads(conduct.PUBLISHED.read_text())["optimizers"]
        self.assertIn("\n".join(conduct.own_lines(own)) + "\n<!-- end of own conduct -->", PAGE.read_text())

    def test_programs_in_cpp_name_their_libraries(self):
        for source in FOLDER.glob("*.cpp"):
            self.assertRegex(source.read_text(), r"(?m)^// flags: -", source.name)

    def test_a_mark_that_last_bits_decide_is_open(self):
        def other_with_other_bits(p, limit, _=None):
            found = right(p, limit)
            if p.r.__name__ == "other":  # the residuals with other bits
                found.x = found.x * (1 + 1e-9)
            return found

        cell = row(other_with_other_bits)["returned point"]
        self.assertEqual(cell["mark"], "–", cell)
        self.assertIn("with other last bits", cell["figures"])

    def test_the_table_is_as_large_as_promised(self):
        table = json.loads(TABLE.read_text())
        self.assertGreaterEqual(len(table["methods"]), 20)
        self.assertGreaterEqual(len({name.split()[0] for name in table["methods"]}), 8)


if __name__ == "__main__":
    unittest.main()
