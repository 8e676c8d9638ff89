"""Fields of grid problems in a real browser. Skipped (77) where Chromium is not installed."""

import math
import pathlib
import sys
import unittest

import browser
import colours
from in_browser import WIDER, InBrowser, resized, run

# The colours of a canvas, cell by cell, as #rrggbb.
CELLS = """const canvas = document.querySelector(arguments[0]);
if (!canvas) return null;
const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height), cells = [];
for (let i = 0; i < data.length; i += 4)
  cells.push('#' + [0, 1, 2].map((j) => data[i + j].toString(16).padStart(2, '0')).join(''));
return cells;"""


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
        return self.cells(f"figure[data-s='{s}'] .picture:nth-child({which}) canvas")

    def slide(self, key):
        self.browser.run("document.querySelector(arguments[0]).focus()", self.fields + " input")
        self.browser.press(key)

    def test_they_stand_with_problems_on_a_grid_alone(self):
        self.assertEqual(len(self.found), len({self.browser.run(
            "return DATA.kinds[arguments[0]]", one["s"]) for one in self.found}), "one of a kind")
        self.assertGreaterEqual(len(self.found), 3)
        count = self.browser.run("return document.querySelectorAll(arguments[0]).length",
                                 self.fields + " .picture canvas")
        self.assertEqual(count, 2 + 2 * len(self.found))
        square = self.browser.run("return DATA.problems.findIndex((one) => one.name === 'square')")
        self.open(f"#problem-{square}")
        self.assertEqual(self.browser.run("return document.querySelectorAll(arguments[0]).length",
                                          f"#problem-{square} .fields"), 0)

    def test_every_picture_has_all_cells_and_words(self):
        for alt, width, height in self.browser.wait(
                "return [...document.querySelectorAll(arguments[0])]"
                ".map((one) => [one.ariaLabel, one.width, one.height])",
                self.fields + " .picture canvas"):
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
        truth = self.cells(".given .picture:nth-child(2) canvas")
        missing = self.picture(s, 2)  # −x*: blue where x* is orange
        warm = [(a, b) for a, b in zip(truth, missing) if distance(a, zero) > 40]
        self.assertGreater(len(warm), 10)
        for a, b in warm:
            self.assertEqual(int(a[1:3], 16) > int(a[5:7], 16), int(b[1:3], 16) < int(b[5:7], 16))
        value = self.browser.run("return document.querySelector(arguments[0]).ariaValueText ??"
                                 " document.querySelector(arguments[0]).getAttribute('aria-valuetext')",
                                 self.fields + " input")
        self.assertEqual(value, "step 1 of 6")

    def test_what_the_slider_draws_at_its_end_is_what_stood_there(self):
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
        self.assertIn(f"nearest to x* for {nearest}", reading)

    def test_a_method_left_out_takes_its_pictures_along(self):
        s = self.found[0]["s"]
        self.browser.run("show('s', DATA.optimizers.map((_, s) => s).filter((s) => s !== arguments[0]))",
                         s)
        self.browser.wait("return document.querySelector(arguments[0]).getClientRects().length === 0",
                          f"{self.fields} figure[data-s='{s}']")

    def test_the_colours_of_both_ends_differ_to_readers_who_see_fewer_of_them(self):
        key = self.cells(".field-key canvas")
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
        given, truth = (self.cells(f".given .picture:nth-child({which}) canvas") for which in (1, 2))
        self.assertGreater(len(truth), 2 * self.N)
        self.assertEqual(given[:self.N], truth[:self.N], "y* is the highest row")
        self.assertEqual(len(set(given[self.N:])), 1, "of y* nothing else is given")
        self.assertGreater(max(map(distance, truth[:self.N], truth[-self.N:])), 10, "it moves")
        found = self.browser.run("return DATA.problems[arguments[0]].fields.found", p)
        self.slide("home")
        for one in found:
            first = self.picture(one["s"], 1)
            self.assertEqual(len(set(first)), 1, "from x = 0 follows 0")
            alt = self.browser.run("return document.querySelector(arguments[0]).ariaLabel",
                                   f"{self.fields} figure[data-s='{one['s']}'] canvas")
            self.assertRegex(alt, r"^x to y .* iteration 0")

    def test_they_fit_a_phone(self):
        resized(self.browser, 400, 800)
        self.open(f"#problem-{self.p}")
        self.browser.wait("return document.querySelector(arguments[0]) !== null",
                          self.fields + " input")
        self.assertLessEqual(self.browser.run(WIDER), 0)
        width = self.browser.run("return document.querySelector(arguments[0]).clientWidth",
                                 self.fields + " .picture canvas")
        self.assertGreaterEqual(width, 120)


if __name__ == "__main__":
    if lacking := browser.missing():
        print(f"skipped: {lacking} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
