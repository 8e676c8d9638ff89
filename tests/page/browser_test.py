"""The page of a real run in a real browser. Skipped (77) where Chromium is not installed."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
import urllib.request

import browser
import colours

PROBLEMS = "rosenbrock,square,beale,scaling,helical-valley"
OPTIMIZERS = "gd,adam,newton,gauss-newton,sip,ceres-lm,nlopt-bobyqa"

# Whether any element that names optimizer or problem `index` can be seen.
IS_SEEN = """const [kind, index] = arguments;
return [...document.querySelectorAll(`[data-${kind}="${index}"]`)]
    .some((element) => element.getClientRects().length > 0);"""
# Whether a canvas under the selector shows more than one colour.
IS_DRAWN = """const place = document.querySelector(arguments[0]);
place.scrollIntoView({block: 'center', behavior: 'instant'});
const canvas = place.querySelector('canvas');
if (!canvas || canvas.width === 0) return false;
const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
return new Set(new Uint32Array(data.buffer)).size > 20;"""
LINES = """const canvas = document.querySelector(arguments[0]).querySelector('canvas');
return Chart.getChart(canvas).data.datasets
    .filter((set) => set.label).map((set) => [set.label, set.data[0] && set.data[0].y]);"""
STANDINGS = """document.getElementById('standings-table').scrollIntoView({behavior: 'instant'});
return [...document.querySelectorAll('#standings-table tbody tr')]
    .filter((row) => row.getClientRects().length > 0)
    .map((row) => [...row.cells].map((cell) => cell.innerText.replace('†', '').trim()));"""


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run([sys.argv[1], "run", "--problem", PROBLEMS, "--optimizer", OPTIMIZERS,
                        "--seeds", "3", "--iterations", "300", "--out", cls.folder.name, "--quiet"],
                       check=False, capture_output=True)  # some of the runs fail: that is data
        report = pathlib.Path(cls.folder.name, "report")
        cls.json = json.loads((report / "report.json").read_text())
        cls.address = (report / "index.html").as_uri()
        cls.browser = browser.Browser()
        cls.browser.open("about:blank")
        cls.browser.log("performance")

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()
        cls.folder.cleanup()

    def setUp(self):
        self.browser.open(self.address)

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])
        elsewhere = [url for url in self.browser.requests()
                     if not url.startswith(("file:", "data:", "blob:", "chrome:"))]
        self.assertEqual(elsewhere, [], "the page asks the network for something")

    def optimizer(self, name):
        return self.browser.run("return DATA.optimizers.indexOf(arguments[0])", name)

    def show_only(self, *names):
        self.browser.run("show('s', arguments[0])", [self.optimizer(name) for name in names])
        self.browser.wait("return shownOf('s').length === arguments[0] && "
                          "location.search !== ''", len(names))

    def test_the_first_screen_says_who_leads_and_needs_no_scrolling(self):
        leader = self.json["optimizers"][0]["optimizer"]
        winner = self.browser.run("return document.querySelector('.winner').innerText")
        self.assertEqual(winner.replace("†", "").strip(), leader)
        bottom = self.browser.run("return Math.max(...[...document.querySelectorAll('.card')]"
                                  ".map((card) => card.getBoundingClientRect().bottom))")
        self.assertLess(bottom, self.browser.run("return innerHeight"))

    def test_curves_paths_and_profile_are_drawn(self):
        for place in ("#problem-0 .curves", "#profile .chart"):
            self.browser.wait(IS_DRAWN, place)
        self.browser.wait(IS_DRAWN, f"#problem-{self.problem_with_plane()} .plane")

    def problem_with_plane(self):
        return self.browser.run("return DATA.problems.findIndex((problem) => problem.x)")

    def test_every_optimizer_has_a_section_with_its_formula(self):
        sections = self.browser.run("return document.querySelectorAll('article.optimizer').length")
        formulas = self.browser.run("return [...document.querySelectorAll("
                                    "'article.optimizer p.formula')].map((one) => one.textContent)")
        self.assertEqual(sections, len(self.json["optimizers"]))
        self.assertEqual(len(formulas), sections)
        self.assertTrue(all(formula.strip() for formula in formulas))

    def test_an_optimizer_left_out_is_nowhere_to_be_seen(self):
        out = self.optimizer("newton")
        self.browser.wait(IS_DRAWN, "#problem-0 .curves")
        self.assertIn("newton", dict(self.browser.run(LINES, "#problem-0 .curves")))
        self.browser.click(".pick[data-kind=s] > summary")
        self.browser.wait("return document.querySelector('[data-choice]') !== null")
        self.browser.click(f"[data-choice='{out}']")
        self.browser.wait("const all = DATA.optimizers.length;"
                          "return document.querySelector('.pick output').textContent === "
                          "`${all - 1}/${all}`")
        self.assertFalse(self.browser.run(IS_SEEN, "s", out))
        self.browser.wait(IS_DRAWN, "#problem-0 .curves")
        self.assertNotIn("newton", dict(self.browser.run(LINES, "#problem-0 .curves")))
        self.assertTrue(self.browser.run(IS_SEEN, "s", self.optimizer("adam")))

    def test_a_problem_left_out_is_nowhere_to_be_seen(self):
        self.browser.run("show('p', [1, 2, 3, 4])")
        self.browser.wait("return location.search.includes('-p=')")
        self.assertFalse(self.browser.run(IS_SEEN, "p", 0))
        self.assertTrue(self.browser.run(IS_SEEN, "p", 1))

    def test_standings_are_those_of_what_is_shown(self):
        self.show_only("gd")
        [row] = self.browser.wait(STANDINGS)
        _, name, _, solved, best, typical = row[:6]
        self.assertEqual(name, "gd")
        self.assertEqual(best, solved.split("/")[0] if solved[0] != "0" else "·")
        self.assertIn(typical, ("1×", "✗"))

    def test_a_view_is_kept_in_the_address(self):
        self.show_only("gd", "adam")
        self.browser.open(self.browser.run("return location.href"))
        self.assertEqual(self.browser.run("return shownOf('s').length"), 2)
        self.assertFalse(self.browser.run(IS_SEEN, "s", self.optimizer("sip")))

    def test_the_slider_moves_tables_and_the_line_in_the_curves(self):
        self.browser.wait(IS_DRAWN, "#problem-0 .curves")
        self.browser.run("document.getElementById('target').focus()")
        self.browser.press("right")
        self.browser.wait("return location.search === '?tau=6.3e-7'")
        self.browser.wait("const lines = Chart.getChart(document.querySelector("
                          "'#problem-0 canvas')).data.datasets;"
                          "return lines.some((set) => set.label === 'τ = 6.3e-7')")
        line = dict(self.browser.run(LINES, "#problem-0 .curves"))["τ = 6.3e-7"]
        self.assertAlmostEqual(line, 10 ** -6.2)
        self.assertIn("6.3e-7", self.browser.run(
            "return document.querySelector('#problem-0 .reached caption').textContent"))

    def test_at_the_tolerances_of_the_report_the_figures_are_its_own(self):
        for target, tau in ((5, "1e-1"), (15, "1e-3"), (30, "1e-6")):
            told = self.browser.run(
                "return standingsOf(arguments[0]).map((one) => [DATA.optimizers[one.s], "
                "one.solved, one.wins, one.reached, one.score.toFixed(9)])", target)
            for optimizer in self.json["optimizers"]:
                own = optimizer["standings"][tau]
                self.assertIn([optimizer["optimizer"], own["solved"], own["wins"],
                               own["reached"], f"{own['score']:.9f}"],
                              told)

    def test_a_heading_sorts_its_column_both_ways(self):
        head = "#standings-table thead th:nth-child(7)"
        for order, is_descending in (("ascending", False), ("descending", True)):
            self.browser.run("document.querySelector(arguments[0] + ' button').click()", head)
            sort = self.browser.run("return document.querySelector(arguments[0]).ariaSort", head)
            self.assertEqual(sort, order)
            runs = [int(row[6].split("/")[0]) for row in self.browser.run(STANDINGS)]
            self.assertEqual(runs, sorted(runs, reverse=is_descending))

    def test_the_bar_works_by_keyboard_alone(self):
        self.browser.press("tab")
        self.assertEqual(self.browser.run("return document.activeElement.className"), "skip")
        self.browser.run("document.querySelector('nav a:last-child').focus()")
        self.browser.press("tab", "enter")
        self.browser.wait("return document.activeElement.type === 'search'")
        self.browser.press(*"gau")
        labels = self.browser.run("return [...document.querySelectorAll('.panel label')]"
                                  ".filter((label) => label.getClientRects().length > 0)"
                                  ".map((label) => label.textContent)")
        self.assertEqual(labels, ["gauss-newton"])
        self.browser.press("escape")
        self.assertEqual(self.browser.run("return document.activeElement.tagName"), "SUMMARY")
        self.assertFalse(self.browser.run("return document.querySelector('.pick').open"))

    def test_colours_differ_to_readers_who_see_fewer_of_them(self):
        told_apart = 20  # in Lab; 2.3 is just noticeable side by side, lines are thin and apart
        for theme, palette in self.browser.run("return COLOURS").items():
            for vision in colours.VISIONS:
                self.assertGreater(colours.least_distance(palette, vision), told_apart,
                                   f"{theme}, {vision}")

    def test_every_cell_offers_the_command_that_repeats_it(self):
        script = """document.getElementById('cells').scrollIntoView({behavior: 'instant'});
return [...document.querySelectorAll('#cells button.copy')].map((button) => button.title)"""
        commands = self.browser.wait(script)
        self.assertEqual(len(commands), sum(bool(cell["figures"]) for cell in self.json["cells"]))
        again = commands[0].replace("./isoline", sys.argv[1])
        answer = subprocess.run(f"{again} --out {self.folder.name} --dry-run", shell=True,
                                check=True, capture_output=True, text=True).stdout
        self.assertIn("3 cells: 3 cached", answer)


class Claims(unittest.TestCase):
    """From the verdicts to the evidence of one claim, in one click."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        claims = ["notebook-gd-table", "notebook-newton-distance", "notebook-start-loss"]
        subprocess.run([sys.argv[1], "claims", *claims, "--out", cls.folder.name],
                       check=True, capture_output=True)
        subprocess.run([sys.argv[1], "report", cls.folder.name], check=True, capture_output=True)
        report = pathlib.Path(cls.folder.name, "report")
        cls.json = json.loads((report / "report.json").read_text())
        cls.address = (report / "index.html").as_uri()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def seen_at(self, page, claim):
        """Where its head stands, and where the bars end."""
        return page.wait("const claim = document.getElementById(arguments[0]);"
                         "const top = claim.getBoundingClientRect().top;"
                         "const bars = document.querySelector('.bars').getBoundingClientRect();"
                         "return claim.open && Math.abs(top - bars.bottom) < 60"
                         " ? [top, bars.bottom] : null", claim)

    def test_a_row_leads_to_its_claim_and_its_address_too(self):
        claim = "claim-" + self.json["claims"][-1]["id"]
        for size in ((1400, 900), (400, 800)):
            page = browser.Browser()
            try:
                page.call("POST", "/goog/cdp/execute", {  # windows are never so narrow
                    "cmd": "Emulation.setDeviceMetricsOverride",
                    "params": {"width": size[0], "height": size[1], "deviceScaleFactor": 1,
                               "mobile": False}})
                page.open(self.address)
                row = f'#claims th a[href="#{claim}"]'
                page.run("document.querySelector(arguments[0])"
                         ".scrollIntoView({behavior: 'instant', block: 'center'})", row)
                page.click(row)
                top, bars = self.seen_at(page, claim)
                self.assertGreaterEqual(top, bars - 1, "its head is behind the bars")
                page.open("about:blank")
                page.open(f"{self.address}#{claim}")
                top, bars = self.seen_at(page, claim)
                self.assertGreaterEqual(top, bars - 1, "its head is behind the bars")
                wide = page.run("return document.documentElement.scrollWidth - innerWidth")
                self.assertLessEqual(wide, 0, "the page is wider than the window")
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()

    def test_records_are_linked_and_the_command_repeats_the_claim(self):
        page = browser.Browser()
        try:
            page.open(self.address)
            links = page.run("return [...document.querySelectorAll('.claim td a')]"
                             ".map((link) => link.href)")
            commands = page.run("return [...document.querySelectorAll('.claim [data-command]')]"
                                ".map((button) => button.dataset.command)")
        finally:
            page.close()
        self.assertGreater(len(links), len(self.json["claims"]) // 2)
        for link in links:
            self.assertTrue(pathlib.Path(urllib.request.url2pathname(link[7:])).exists(), link)
        decided = [claim for claim in self.json["claims"] if claim["sets"]]
        self.assertEqual(commands, [claim["command"] for claim in decided])
        again = commands[0].replace("./isoline", sys.argv[1])
        answer = subprocess.run(again, shell=True, check=False, capture_output=True, text=True,
                                cwd=self.folder.name)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        self.assertIn(decided[0]["sentence"], " ".join(answer.stdout.split()))


if __name__ == "__main__":
    if lacking := browser.missing():
        print(f"skipped: {lacking} is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
