"""Fields of grid problems, and two results compared, in a real browser. Skipped (77) where Chromium
is not installed."""

import math
import pathlib
import statistics
import sys
import unittest

import browser
import colours
from in_browser import WIDER, InBrowser, resized, run

# The colours of an image, cell by cell, as #rrggbb.
CELLS = """const image = document.querySelector(arguments[0]);
if (!image || !image.complete || image.naturalWidth === 0) return null;
const canvas = document.createElement('canvas');
canvas.width = image.naturalWidth; canvas.height = image.naturalHeight;
const context = canvas.getContext('2d');
context.drawImage(image, 0, 0);
const {data} = context.getImageData(0, 0, canvas.width, canvas.height), cells = [];
for (let i = 0; i < data.length; i += 4)
  cells.push('#' + [0, 1, 2].map((j) => data[i + j].toString(16).padStart(2, '0')).join(''));
return cells;"""
IS_DRAWN = """const canvas = document.querySelector(arguments[0])?.querySelector('canvas');
if (!canvas || canvas.width === 0) return false;
const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
return new Set(new Uint32Array(data.buffer)).size > 20;"""


def distance(one, other):
    return max(abs(int(one[i:i + 2], 16) - int(other[i:i + 2], 16)) for i in (1, 3, 5))


class Fields(InBrowser):
    N = 12

    @classmethod
    def made(cls, folder):
        run("run", "--problem", f"poisson[N={cls.N}],heat[N={cls.N}],burgers[N={cls.N}],square",
            "--optimizer", "gd,adam,sip,gauss-newton", "--iterations", "60", "--out", folder,
            "--quiet")
        return pathlib.Path(folder, "report", "index.html")

    def setUp(self):
        super().setUp()
        self.open("")
        self.p = self.browser.run("return DATA.problems.findIndex((one) => one.name === 'poisson')")
        self.open(f"#problem-{self.p}")
        self.fields = f"#problem-{self.p} .fields"
        self.browser.wait("return document.querySelector(arguments[0]) !== null",
                          self.fields + " input")
        self.found = self.browser.run("return DATA.problems[arguments[0]].fields.found", self.p)

    def cells(self, selector):
        return self.browser.wait(CELLS, f"{self.fields} {selector}")

    def picture(self, s, which):
        return self.cells(f"figure[data-s='{s}'] .picture:nth-child({which}) img")

    def slide(self, key):
        self.browser.run("document.querySelector(arguments[0]).focus()", self.fields + " input")
        self.browser.press(key)

    def test_they_stand_with_problems_on_a_grid_alone(self):
        self.assertEqual(len(self.found), len({self.browser.run(
            "return DATA.kinds[arguments[0]]", one["s"]) for one in self.found}), "one of a kind")
        self.assertGreaterEqual(len(self.found), 3)
        count = self.browser.run("return document.querySelectorAll(arguments[0]).length",
                                 self.fields + " .picture img")
        self.assertEqual(count, 2 + 2 * len(self.found))
        square = self.browser.run("return DATA.problems.findIndex((one) => one.name === 'square')")
        self.open(f"#problem-{square}")
        self.assertEqual(self.browser.run("return document.querySelectorAll(arguments[0]).length",
                                          f"#problem-{square} .fields"), 0)

    def test_every_picture_has_all_cells_and_words(self):
        for alt, width, height in self.browser.wait(
                "const all = [...document.querySelectorAll(arguments[0])];"
                "return all.every((one) => one.complete) &&"
                " all.map((one) => [one.alt, one.naturalWidth, one.naturalHeight])",
                self.fields + " .picture img"):
            self.assertEqual((width, height), (self.N, self.N))
            self.assertRegex(alt, r"(source|potential).*from .* to|x − x\*")

    def test_the_slider_goes_through_the_kept_steps_by_keyboard(self):
        s = self.found[0]["s"]
        last = self.picture(s, 1)
        self.slide("home")
        for one in self.found:
            told = self.browser.run("return document.querySelector(arguments[0]).innerText",
                                    f"{self.fields} figure[data-s='{one['s']}'] .at")
            self.assertEqual(told, "0")
        first = self.picture(s, 1)
        self.assertEqual(len(set(first)), 1, "x = 0 has one colour, that of zero")
        self.assertNotEqual(first, last)
        zero = first[0]
        truth = self.cells(".given .picture:nth-child(2) img")
        missing = self.picture(s, 2)  # −x*: blue where x* is orange
        warm = [(a, b) for a, b in zip(truth, missing) if distance(a, zero) > 40]
        self.assertGreater(len(warm), 10)
        for a, b in warm:
            self.assertEqual(int(a[1:3], 16) > int(a[5:7], 16), int(b[1:3], 16) < int(b[5:7], 16))
        value = self.browser.run("return document.querySelector(arguments[0]).ariaValueText ??"
                                 " document.querySelector(arguments[0]).getAttribute('aria-valuetext')",
                                 self.fields + " input")
        self.assertEqual(value, "step 1 of 6")

    def test_what_the_slider_draws_at_its_end_is_what_stands_without_scripts(self):
        for one in self.found:
            still = [self.picture(one["s"], which) for which in (1, 2)]
            self.slide("home")
            self.slide("end")
            drawn = [self.picture(one["s"], which) for which in (1, 2)]
            self.assertEqual(still[0], drawn[0])
            for a, b in zip(still[1], drawn[1]):  # of rounded bytes, or of the numbers themselves
                self.assertLessEqual(distance(a, b), 6)

    def test_the_method_nearest_to_the_solution_is_told_so(self):
        apart = {one["s"]: float(one["apart"][-1][2:]) for one in self.found}  # "= 0.1", "< 1e-7"
        nearest = self.browser.run("return DATA.optimizers[arguments[0]]",
                                   min(apart, key=apart.get))
        reading = self.browser.run("return document.querySelector(arguments[0]).innerText",
                                   self.fields + " .reading")
        self.assertIn(f"the x nearest to x* is that of {nearest}", reading)

    def test_a_method_left_out_takes_its_pictures_along(self):
        s = self.found[0]["s"]
        self.browser.run("show('s', DATA.optimizers.map((_, s) => s).filter((s) => s !== arguments[0]))",
                         s)
        self.browser.wait("return document.querySelector(arguments[0]).getClientRects().length === 0",
                          f"{self.fields} figure[data-s='{s}']")

    def test_the_colours_of_both_ends_differ_to_readers_who_see_fewer_of_them(self):
        key = self.cells(".field-key img")
        self.assertEqual(len(key), 129)
        for vision in colours.VISIONS:
            lab = [colours.lab(one, vision) for one in key]
            self.assertGreater(math.dist(lab[0], lab[-1]), 55, vision)
            self.assertGreater(math.dist(lab[32], lab[-33]), 25, vision)
            steps = [math.dist(lab[i], lab[i + 8]) for i in range(0, 120, 8)]
            self.assertLess(max(steps) / min(steps), 2.2, f"{vision}: its steps are even")

    def test_a_history_goes_from_x_at_the_bottom_to_y_at_the_top(self):
        p = self.browser.run("return DATA.problems.findIndex((one) => one.name === 'burgers')")
        self.open(f"#problem-{p}")
        self.fields = f"#problem-{p} .fields"
        self.browser.wait("return document.querySelector(arguments[0]) !== null",
                          self.fields + " input")
        given, truth = (self.cells(f".given .picture:nth-child({which}) img") for which in (1, 2))
        self.assertGreater(len(truth), 2 * self.N)
        self.assertEqual(given[:self.N], truth[:self.N], "y* is the highest row")
        self.assertEqual(len(set(given[self.N:])), 1, "of y* nothing else is given")
        self.assertGreater(max(map(distance, truth[:self.N], truth[-self.N:])), 10, "it moves")
        found = self.browser.run("return DATA.problems[arguments[0]].fields.found", p)
        self.slide("home")
        for one in found:
            first = self.picture(one["s"], 1)
            self.assertEqual(len(set(first)), 1, "from x = 0 follows 0")
            alt = self.browser.run("return document.querySelector(arguments[0]).alt",
                                   f"{self.fields} figure[data-s='{one['s']}'] img")
            self.assertRegex(alt, r"^x → y of .* at iteration 0")

    def test_they_fit_a_phone(self):
        resized(self.browser, 400, 800)
        self.open(f"#problem-{self.p}")
        self.browser.wait("return document.querySelector(arguments[0]) !== null",
                          self.fields + " input")
        self.assertLessEqual(self.browser.run(WIDER), 0)
        width = self.browser.run("return document.querySelector(arguments[0]).clientWidth",
                                 self.fields + " .picture img")
        self.assertGreaterEqual(width, 120)

    def test_without_scripts_every_picture_stands_still(self):
        text = pathlib.Path(self.folder.name, "report", "index.html").read_text()
        articles = text.split("<article ")[1:]
        grids = [one for one in articles if "class=fields" in one.split("</article>")[0]]
        self.assertEqual(len(grids), 3)
        for one in grids:
            inner = one.split("<noscript>")[1].split("</noscript>")[0]
            self.assertEqual(inner.count("<img "), 3 + 2 * len(self.found))
            self.assertNotIn("type=range", inner)


def doublings(a, b):
    """log2 of what BASE takes over what NEW takes; unsolved is 64 times as much."""
    if a is None or b is None:
        return 6 if b is not None else -6
    return max(-6, min(6, math.log2(max(a, 1)) - math.log2(max(b, 1))))


class Sides(InBrowser):
    PROBLEMS = "rosenbrock,square,beale,helical-valley,wood"
    OPTIMIZERS = "gd,adam,newton,gauss-newton"

    @classmethod
    def made(cls, folder):
        cls.sides = [pathlib.Path(folder, name) for name in ("old", "new")]
        for side, iterations in zip(cls.sides, ("400", "25")):
            run("run", "--problem", cls.PROBLEMS, "--optimizer", cls.OPTIMIZERS, "--iterations",
                iterations, "--out", str(side), "--quiet")
        page = pathlib.Path(folder, "compared.html")
        cls.answer = run("compare", *map(str, cls.sides), "--html", str(page))
        return page

    def test_it_is_written_and_the_answer_is_that_of_the_gate(self):
        plain = run("compare", *map(str, self.sides))
        self.assertEqual(self.answer.returncode, plain.returncode)
        self.assertEqual(self.answer.stdout, plain.stdout)
        self.open("#changes")
        told = self.browser.run("return document.getElementById('changes').innerText")
        self.assertIn(plain.stdout.split("\n")[0].split(": ", 1)[1][:40], " ".join(told.split()))

    def test_it_opens_with_new_against_base_over_all_methods(self):
        self.open("")
        sentence = self.browser.wait("return document.querySelector('#pair .verdict')?.innerText")
        self.assertRegex(sentence, r"^NEW needs less declared work than BASE on \d of \d problems")
        rows = self.browser.run("return [...document.querySelectorAll('#pair tbody tr')]"
                                ".map((row) => row.cells[0].innerText)")
        self.assertEqual(sorted(rows), sorted(self.OPTIMIZERS.split(",")))

    def test_a_method_against_itself_has_the_figures_of_a_pair(self):
        self.open("")
        for a, b, name in self.browser.run("return SIDES"):
            told, same = self.browser.run(
                "return [pairOfAll([[arguments[0], arguments[1]]]), pairOf(arguments[0], arguments[1])]"
                ".map((one) => [one.wins, one.losses, one.ties, one.neither, one.typical])", a, b)
            self.assertEqual(told, same)
            self.browser.run("side.chosen = SIDES.findIndex((one) => one[2] === arguments[0]);"
                             "refreshAll()", name)
            sentence = self.browser.wait(
                "const text = document.querySelector('#pair .verdict').innerText;"
                "return text.startsWith(arguments[0] + ':') && text", name)
            self.assertRegex(sentence, r"NEW|neither")

    def test_all_methods_together_are_medians_over_them(self):
        self.open("")
        own = self.browser.run(
            "return DATA.problems.map((problem) => [problem.name, SIDES.map(([a, b]) => [a, b].map((s) => {"
            " const cell = cellOf(problem, s), work = cell === undefined ? undefined : takenBy(cell);"
            " return work === undefined ? undefined : work === Infinity ? null : work; }))])")
        medians = {}
        for name, pairs in own:
            values = [doublings(a, b) for a, b in pairs if a is not None or b is not None]
            if values:
                medians[name] = statistics.median(values)
        told = self.browser.run("const told = pairOfAll(SIDES); return [told.wins, told.losses, told.ties,"
                                " told.typical]")
        values = list(medians.values())
        self.assertEqual(told[:3], [sum(v < 0 for v in values), sum(v > 0 for v in values),
                                    sum(v == 0 for v in values)])
        self.assertAlmostEqual(told[3], 2 ** -statistics.median(values))

    def test_a_bar_opens_the_curves_of_both_sides(self):
        self.open("")
        self.browser.wait("return document.querySelector('#pair tbody button') !== null")
        self.browser.click("#pair tbody button")
        self.browser.wait("return side.chosen >= 0")
        self.browser.click("#pair .bars-of a")
        self.browser.wait(IS_DRAWN, ".problem.chosen .curves")
        names, dashes = self.browser.run(
            "const sets = Chart.getChart(document.querySelector('.problem.chosen .curves canvas'))"
            ".data.datasets.filter((set) => set.optimizer !== undefined);"
            "return [sets.map((set) => set.label), sets.map((set) => set.borderDash.length)]")
        self.assertEqual(len(names), 2)
        for name, dash in zip(names, dashes):
            self.assertEqual(dash > 0, name.endswith(", BASE"), name)

    def test_each_tab_fits_a_phone_and_the_file_stands_alone(self):
        resized(self.browser, 400, 800)
        for tab in ("compare", "changes", "problems"):
            self.open(f"#{tab}")
            self.assertLessEqual(self.browser.run(WIDER), 0, f"{tab} is wider than the window")
        text = pathlib.Path(self.folder.name, "compared.html").read_text()
        self.assertIn("Content-Security-Policy", text)
        for outside in ("src=\"http", "href=\"http", "@import"):
            self.assertNotIn(outside, text)

    def test_anything_but_two_folders_is_refused_before_it_is_read(self):
        report = self.sides[0] / "report" / "report.json"
        refused = run("compare", str(report), str(self.sides[1]), "--html", "x.html")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("two result folders", refused.stderr)
        self.assertFalse(pathlib.Path("x.html").exists())


if __name__ == "__main__":
    if lacking := browser.missing():
        print(f"skipped: {lacking} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
