"""The page of a real run in a real browser. Skipped (77) where Chromium is not installed."""

import base64
import io
import itertools
import json
import pathlib
import random
import re
import subprocess
import sys
import tarfile
import tempfile
import unittest
import urllib.request
import xml.etree.ElementTree

import browser
import colours
from in_browser import WIDER, InBrowser, resized, run

PROBLEMS = "rosenbrock,square,beale,scaling,helical-valley,brown-badly-scaled"
OPTIMIZERS = "gd,adam,newton,gauss-newton,sip,ceres-lm,levenberg-marquardt,nlopt-bobyqa"

# Whether any element that names optimizer or problem `index` can be seen.
IS_SEEN = """const [kind, index] = arguments;
return [...document.querySelectorAll(`[data-${kind}="${index}"]`)]
    .some((element) => element.getClientRects().length > 0);"""
# Whether a chart under the selector is laid out with lines in it.
IS_DRAWN = """const place = document.querySelector(arguments[0]);
if (!place) return false;
place.scrollIntoView({block: 'center', behavior: 'instant'});
const chart = [...place.querySelectorAll('.chart')].find((one) => one.getClientRects().length > 0);
return chart !== undefined && linesOf(chart).some((line) => line.getClientRects().length > 0);"""
# Of each line that is shown its name and the points it is drawn through.
LINES = """const charts = [...document.querySelectorAll(arguments[0] + ' .chart')];
const chart = charts.find((one) => one.getClientRects().length > 0);
const [x, y] = [axisOf(chart, 'x'), axisOf(chart, 'y')];
return linesOf(chart).filter(isLineShown).map((line) => [nameOf(line), pointsOf(pathOf(line))
    .map((point) => [valueAt(x, point[0] / AREA), valueAt(y, 1 - point[1] / AREA)])]);"""
STANDINGS = """return [...document.querySelectorAll('#standings-table tbody tr')]
    .filter((row) => row.getClientRects().length > 0)
    .map((row) => [...row.cells].map((cell) => cell.innerText.replace('†', '').trim()));"""
# The numbers of the tables of a tab, and those of which a press opens nothing.
SILENT = """const tab = document.getElementById(arguments[0]), drawer = document.getElementById('drawer');
for (const one of tab.querySelectorAll('details:not([open])')) {
  one.open = true;
  unpack(one);
  unpackAll(one);
}
const numbers = [...tab.querySelectorAll('td')].filter((cell) => /^[\\d✗≈]/.test(cell.textContent) &&
    cell.closest('[data-table=certified] tr:not([data-s]), [data-table=builds]') === null);
const silent = numbers.filter((cell) => {
  drawer.close();
  cell.click();
  const isNone = cell.textContent.startsWith('0');  // of none nothing has to be shown
  return !drawer.open || (drawer.querySelector('li, td, code') === null && !isNone);
});
drawer.close();
return [numbers.length,
    silent.map((cell) => `${cell.closest('table').dataset.table}: ${cell.textContent}`)];"""
# Heads of columns of an error in x.
HEADS = """return [...document.querySelectorAll('th[scope=col], th[scope=colgroup]')]
    .map((head) => head.textContent).filter((text) => /error in x/.test(text));"""
# How many screens below the top an element stands, and whether it can be seen at all.
SCREENS_DOWN = """const box = document.querySelector(arguments[0]).getBoundingClientRect();
return box.height > 0 ? (box.bottom + scrollY) / innerHeight : null;"""


# Each text that the first screen shows, but for names of methods, ticks, cells of tables, and controls.
FIRST_SCREEN = """const texts = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
for (let node = walker.nextNode(); node !== null; node = walker.nextNode()) {
  const {parentElement} = node, range = document.createRange();
  range.selectNodeContents(node);
  const box = range.getBoundingClientRect();
  const apart = 'script, noscript, style, button, #view, td, tbody th, .names .name, .ends, [data-line]';
  if (box.width === 0 || box.right < 0 || box.top >= innerHeight || !parentElement.checkVisibility() ||
      parentElement.closest(apart) !== null) continue;
  if (parentElement.closest('svg') !== null && !/[a-z]{2}/i.test(node.textContent)) continue;
  texts.push(node.textContent.trim());
}
return texts.join(' ').split(/\\s+/).filter((word) => /[\\p{L}\\d]/u.test(word) &&
    !DATA.optimizers.includes(word.replace(/^\\(|[:,;)]$/g, '')));"""
# Of the chart that a problem shows: of each line that is shown its name, whether it ends worse, and where it
# first reaches each goal, beside the table's number.
CROSSINGS = """const [p, taus] = arguments, problem = DATA.problems[p];
const chart = [...document.querySelectorAll(`#problem-${p} .curves .chart`)].find((one) => one.getClientRects().length > 0);
const line = chart.querySelector('.tau'), [x, y] = [axisOf(chart, 'x'), axisOf(chart, 'y')];
if (line === null) return [];
return linesOf(chart).filter(isLineShown).flatMap((group) => taus.map((target) => {
  const goal = Number(line.dataset.scale) * Math.max(tauOf(target), problem.goal ?? 0);
  const edge = (1 - shareOf(y, goal)) * AREA, at = pointsOf(pathOf(group)).find(([, up]) => up >= edge - 1);
  const taken = takenBy(cellOf(problem, lineOf(group)), target);
  return [`${nameOf(group)} on ${problem.spec} to ${tauName(target)}`, group.matches('[data-worse]'), at === undefined ? null : valueAt(x, at[0] / AREA), taken === Infinity ? null : taken];
}));"""


class Page(InBrowser):
    @classmethod
    def made(cls, folder):
        run("run", "--problem", PROBLEMS, "--optimizer", OPTIMIZERS, "--seeds", "3",
            "--iterations", "400", "--out", folder, "--quiet")
        report = pathlib.Path(folder, "report")
        cls.json = json.loads((report / "report.json").read_text())
        return report / "index.html"

    def setUp(self):
        super().setUp()
        self.open("")

    def optimizer(self, name):
        return self.browser.run("return DATA.optimizers.indexOf(arguments[0])", name)

    def problem(self, name):
        return self.browser.run("return DATA.problems.findIndex((one) => one.spec === arguments[0])",
                                name)

    def show_only(self, *names):
        self.browser.run("show('s', arguments[0])", [self.optimizer(name) for name in names])
        self.browser.wait("return shownOf('s').length === arguments[0] && "
                          "location.search !== ''", len(names))

    def lines_of(self, problem):
        place = f"#problem-{self.problem(problem)} .curves"
        self.browser.run("showLines(arguments[0], DATA.optimizers.keys())", self.problem(problem))
        self.browser.wait(IS_DRAWN, place)
        return dict(self.browser.run(LINES, place))

    # --- tabs

    def test_one_tab_is_laid_out_at_a_time_and_each_has_an_address(self):
        listed = self.browser.run("return [...document.querySelectorAll('nav a')].map((link) => link.hash.slice(1))")
        self.assertEqual(listed, ["overview", "choose", "compare", "problems", "methods", "statistics", "runs"])
        for tab in listed:
            self.open(f"#{tab}")
            seen = self.browser.run("return [...document.querySelectorAll('.tab')].filter((tab) => "
                                    "tab.getClientRects().length > 0).map((tab) => tab.id)")
            self.assertEqual(seen, [tab])
            names = self.browser.run("return [...document.querySelectorAll('[role=region]')]"
                                     ".map((one) => one.getAttribute('aria-label'))")
            self.assertEqual(len(names), len(set(names)), "landmarks of one name")
            self.assertEqual(self.browser.run("return document.querySelectorAll("
                                              "'nav [aria-current]').length"), 1)
            count = self.browser.run("return document.querySelectorAll('*').length")
            self.assertLess(count, 15000)
            stops = self.browser.run(
                "return [...document.querySelectorAll('a[href],button,input,select,summary,"
                "[tabindex=\"0\"]')].filter((one) => one.tabIndex >= 0 && "
                "one.getClientRects().length > 0).length")
            self.assertLessEqual(stops, 250)

    def test_an_address_of_what_stands_in_a_tab_leads_there(self):
        for address, tab in (("problem-2", "problems"), ("optimizer-3", "methods"),
                             ("tuning", "statistics"), ("failures", "runs")):
            self.open(f"#{address}")
            place = self.browser.run(
                "const place = document.getElementById(arguments[0]), box = "
                "place.getBoundingClientRect(); const bars = document.querySelector('.bars')"
                ".getBoundingClientRect(); return [place.closest('.tab').id, box.top - bars.bottom, "
                "box.height, innerHeight + scrollY >= document.documentElement.scrollHeight - 1]",
                address)
            self.assertEqual(place[0], tab)
            self.assertGreater(place[2], 0)
            self.assertGreaterEqual(place[1], -1, f"{address} is behind the bars")
            self.assertTrue(place[1] < 60 or place[3], f"{address}: {place[1]} px off")

    def test_a_page_opened_at_a_tab_begins_at_its_top(self):
        for tab in ("overview", "problems", "statistics"):
            self.open(f"#{tab}")
            self.browser.wait("return document.readyState === 'complete'")
            self.browser.run("return new Promise((done) => requestAnimationFrame(() => "
                             "requestAnimationFrame(done)))")
            self.assertEqual(self.browser.run("return scrollY"), 0, tab)

    def test_the_first_tab_shades_the_heat_map_by_how_far_from_the_best(self):
        shades = self.browser.wait("const all = [...document.querySelectorAll('#heat td[data-p]')]"
                                   ".map((cell) => cell.className.split(' ')[0]);"
                                   "return all.length > 0 && all")
        self.assertGreater(len({name for name in shades if name[:1] == "h"}), 3)

    def test_the_first_tab_says_who_leads_within_two_screens(self):
        verdict = self.browser.run("return document.querySelector('.verdict').innerText")
        self.assertIn(self.json["leader"]["optimizer"], verdict)
        self.assertFalse(self.json["leader"]["significant"])
        self.assertLessEqual(len(verdict.split()), 60)
        self.assertLessEqual(self.browser.run(
            "return document.querySelectorAll('#overview > :is(.verdict, .lead):not(.first ~ *)').length"), 3)
        said = self.browser.run("return [...document.querySelectorAll('#overview > :is(.verdict, .lead):not(.first ~ *)')]"
                                ".map((one) => one.innerText).join(' ')")
        self.assertLessEqual(len(re.findall(r"[.](?:\s|$)", said)), 3, said)
        self.assertLess(self.browser.run("return document.documentElement.scrollHeight "
                                         "/ innerHeight"), 2.2)
        self.assertEqual(self.browser.run("return document.querySelectorAll('.settled dt').length"), 3)

    def test_the_first_screen_has_few_words_the_ranking_and_three_ways_on(self):
        self.browser.wait(STANDINGS)
        left, top, bottom = self.browser.wait("const race = document.querySelector('#motion .race')?.getBoundingClientRect();"
                                              "return race && [race.left, race.top, race.bottom]")
        self.assertGreater(left, 700, "the race is on the right")
        self.assertLess(top, bottom)
        self.assertLessEqual(bottom, 900)
        words = self.browser.run(FIRST_SCREEN)
        self.assertGreater(len(words), 30)
        self.assertLessEqual(len(words), 120, words)
        for link in self.browser.run("return [...document.querySelectorAll('.ways a')].map((one) => one.hash)"):
            self.open(link)
            self.assertEqual(self.browser.run("return document.querySelector('.tab.open').id"),
                             self.browser.run("return placeOf(arguments[0].slice(1)).closest('.tab').id", link))

    def test_a_wide_screen_is_used(self):
        resized(self.browser, 1920, 1000)
        self.assertGreater(self.browser.run("return document.querySelector('main').clientWidth"), 1850)

    def test_terms_of_the_glossary_open_beside_their_columns(self):
        self.assertLessEqual(len(self.browser.run("return Object.keys(DATA.terms)")), 25)
        tip = "return document.getElementById('tip').hidden ? null : " \
              "document.querySelector('#tip b').innerText"
        self.browser.wait("return document.querySelector('#standings-table thead') !== null")
        seen = self.browser.run(
            "return [...document.querySelectorAll('#standings-table thead th')].map((head) => {"
            "head.dispatchEvent(new PointerEvent('pointerover', {bubbles: true}));"
            f"const seen = (() => {{{tip}}})();"
            "head.dispatchEvent(new PointerEvent('pointerout', {bubbles: true})); return seen;})")
        self.assertGreaterEqual({"score", "solved", "wins", "median slowdown"} & set(seen),
                                {"score", "solved", "wins", "median slowdown"})

    def test_curves_and_planes_are_drawn(self):
        for name in ("rosenbrock", "beale"):
            p = self.problem(name)
            self.open(f"#problem-{p}")
            self.browser.wait(IS_DRAWN, f"#problem-{p} .curves")
            self.browser.wait(IS_DRAWN, f"#problem-{p} .plane")

    def test_every_method_has_a_card_with_its_formula(self):
        for index, optimizer in enumerate(self.json["optimizers"]):
            self.open(f"#optimizer-{index}")
            card = self.browser.run("const card = document.querySelector('.optimizer.chosen');"
                                    "return [card.querySelector('h3').innerText, "
                                    "card.querySelector('p.formula').innerText]")
            self.assertIn(optimizer["optimizer"], card[0])
            self.assertTrue(card[1].strip())

    def test_a_card_says_what_is_not_solved_by_which_quantity_and_why(self):
        self.open(f"#optimizer-{self.optimizer('gd')}")
        terms = self.browser.run("return [...document.querySelectorAll('.optimizer.chosen dt')].map((one) => "
                                 "[one.innerText, one.nextElementSibling.innerText])")
        missed = [text for term, text in terms if term.startswith("does not solve: ")]
        self.assertGreater(len(missed), 0)
        for text in missed:
            self.assertRegex(text, r"(error in x|loss gap) \S+.*, goal \S+")
        for index in range(len(self.json["optimizers"])):
            self.open(f"#optimizer-{index}")
            self.assertNotRegex(self.browser.run("return document.querySelector('.optimizer.chosen').innerText"), r"\d of 0\b")

    def test_the_grid_of_methods_marks_what_was_measured(self):
        self.open("#methods")
        marks = self.browser.run("return [...document.querySelectorAll('#methods-table tbody tr')]"
                                 ".map((row) => [row.cells[0].innerText.replace('†', '').trim(), "
                                 "[...row.cells].slice(2, 12).map((cell) => cell.innerText).join('')])")
        marks = dict(marks)
        self.assertEqual(marks["newton"][:3], "✓✓✓")
        self.assertEqual(marks["gd"][0], "✗")

    # --- what is shown

    def test_a_method_left_out_is_nowhere_to_be_seen_and_no_figure_changes(self):
        before = self.browser.wait(STANDINGS)  # empty until they are drawn
        out = self.optimizer("newton")
        self.browser.click(".pick[data-kind=s] > summary")
        self.browser.wait("return document.querySelector('[data-choice]') !== null")
        self.browser.click(f"[data-choice='{out}']")
        self.browser.wait("const all = DATA.optimizers.length;"
                          "return document.querySelector('.pick output').textContent === "
                          "`${all - 1}/${all}`")
        self.assertFalse(self.browser.run(IS_SEEN, "s", out))
        self.assertTrue(self.browser.run(IS_SEEN, "s", self.optimizer("adam")))
        after = self.browser.run(STANDINGS)
        self.assertEqual(after, [row for row in before if row[1] != "newton"])
        self.assertIn("still refer to all",
                      self.browser.run("return document.getElementById('filtered').innerText"))
        self.open(f"?-o=newton#problem-{self.problem('beale')}")
        self.assertNotIn("newton", self.lines_of("beale"))

    def test_a_problem_left_out_is_nowhere_to_be_seen(self):
        self.browser.run("show('p', [1, 2, 3, 4])")
        self.browser.wait("return location.search.includes('p=')")
        self.assertFalse(self.browser.run(IS_SEEN, "p", 0))
        self.assertTrue(self.browser.run(IS_SEEN, "p", 1))

    def test_a_view_is_kept_in_the_address(self):
        self.show_only("gd", "adam")
        self.browser.open(self.browser.run("return location.href"))
        self.assertEqual(self.browser.run("return shownOf('s').length"), 2)
        self.assertFalse(self.browser.run(IS_SEEN, "s", self.optimizer("sip")))

    def test_the_slider_and_the_measure_move_tables_and_curves(self):
        self.open(f"#problem-{self.problem('beale')}")
        self.browser.run("document.getElementById('target').focus()")
        self.browser.press("right")
        self.browser.wait("return location.search === '?tau=6.3e-7'")
        self.browser.wait(IS_DRAWN, ".problem.chosen .curves")
        self.browser.wait(  # coordinates are whole
            "const chart = document.querySelector('.problem.chosen .chart:not([hidden])');"
            "const y = chart.querySelector('.tau').getAttribute('d').match(/^M\\S+ (\\d+)/)[1];"
            "return Math.abs(valueAt(axisOf(chart, 'y'), 1 - y / AREA) / 10 ** -6.2 - 1) < 0.02")
        self.browser.run("[...document.querySelectorAll('#measures button')]"
                         ".find((button) => button.textContent === 'time').click()")
        self.browser.wait("return location.search === '?tau=6.3e-7&by=time'")
        self.browser.wait("return document.querySelector('.reached caption').textContent"
                          ".includes('to reach τ = 6.3e-7')")
        self.browser.wait("return document.querySelector('.problem.chosen "
                          ".chart:not([hidden])').dataset.by === 'time'")

    def test_at_the_tolerances_of_the_report_the_figures_are_its_own(self):
        for target, tau in ((5, "1e-1"), (15, "1e-3"), (30, "1e-6")):
            told = self.browser.run(
                "return standingsAt(DEFAULT_MEASURE, arguments[0]).map((one) => "
                "[DATA.optimizers[one.s], one.solved, one.wins, one.reached, one.score])", target)
            told = {row[0]: row[1:] for row in told}
            for optimizer in self.json["optimizers"]:
                own = optimizer["standings"][tau]
                if own["settings"] == 0:
                    self.assertNotIn(optimizer["optimizer"], told, "it is not ranked")
                    continue
                solved, wins, reached, score = told[optimizer["optimizer"]]
                self.assertEqual([solved, wins, reached],
                                 [own["solved"], own["wins"], own["reached"]])
                self.assertAlmostEqual(score, own["score"], delta=1e-4)

    def test_a_heading_sorts_its_column_both_ways(self):
        head = "#standings-table thead th:nth-child(8)"
        for order, is_descending in (("ascending", False), ("descending", True)):
            self.browser.wait("return document.querySelector(arguments[0] + ' button') !== null", head)
            self.browser.run("document.querySelector(arguments[0] + ' button').click()", head)
            sort = self.browser.run("return document.querySelector(arguments[0]).ariaSort", head)
            self.assertEqual(sort, order)
            runs = [int(row[7].split("/")[0]) for row in self.browser.run(STANDINGS)]
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

    def test_every_cell_offers_the_command_that_repeats_it(self):
        self.open("#runs")
        commands = self.browser.wait("return [...document.querySelectorAll('#cells button.copy')]"
                                     ".map((button) => button.dataset.command)")
        self.assertEqual(len(commands), sum(bool(cell["figures"]) for cell in self.json["cells"]))
        again = commands[0].replace("./isoline", sys.argv[1])
        answer = subprocess.run(f"{again} --out {self.folder.name} --dry-run", shell=True,
                                check=True, capture_output=True, text=True).stdout
        self.assertIn("3 cells: 3 cached", answer)

    # --- drawings without bias

    def test_labels_at_the_ends_of_lines_are_placed_once_whatever_their_heights(self):
        for heights in ([100] * 40, [100 + 0.1 * i for i in range(40)], [1e9, 1e9, float(2**53)],
                        [0.1 + 0.2, 0.3, 13.3, 13.299999999999999]):
            ends = [{"x": 10, "y": y, "width": 50} for y in heights]
            placed = self.browser.run("return placedEnds(arguments[0])", ends)
            self.assertEqual(len(placed), len(ends))

    def test_a_line_crosses_a_tolerance_where_the_table_says(self):
        for name in ("beale", "brown-badly-scaled", "rosenbrock"):
            self.open(f"#problem-{self.problem(name)}")
            lines = self.lines_of(name)
            told = dict(self.browser.run(
                "return DATA.problems[arguments[0]].cells.filter(isMeasured).map((cell) => "
                "[DATA.optimizers[cell.s], takenBy(cell) === Infinity ? null : takenBy(cell)])",
                self.problem(name)))
            for method, points in lines.items():
                if method not in told:
                    continue
                crossed = [x for x, y in points if y <= 1e-6 * 1.02]  # coordinates are whole
                self.assertEqual(bool(crossed), told[method] is not None, f"{method} on {name}")
                if crossed:
                    self.assertAlmostEqual(crossed[0] / told[method], 1, delta=0.02)
            stepped = self.browser.run(
                "return linesOf(document.querySelector('.problem.chosen .chart:not([hidden])'))"
                ".every((line) => !pathOf(line).getAttribute('d').includes('l'))")
            self.assertTrue(stepped, "points are joined straight")

    def test_every_line_crosses_every_tolerance_where_the_table_says(self):
        count = 0
        for p in range(len(self.json["problems"])):
            self.open(f"#problem-{p}")
            self.browser.run("showLines(arguments[0], DATA.optimizers.keys())", p)
            self.browser.wait(IS_DRAWN, f"#problem-{p} .curves")
            for name, ends_worse, crossed, told in self.browser.run(CROSSINGS, p, [5, 15, 30]):
                count += told is not None
                if told is None:
                    self.assertTrue(crossed is None or ends_worse, name)
                else:
                    self.assertIsNotNone(crossed, name)
                    self.assertAlmostEqual(crossed / told, 1, delta=0.01, msg=name)
        self.assertGreater(count, 40)

    def test_a_filter_empties_no_plot(self):
        last = len(self.json["optimizers"]) - 1
        self.browser.run("show('s', [arguments[0]])", last)
        for p in range(len(self.json["problems"])):
            self.open(f"?o={self.json['optimizers'][last]['optimizer']}#problem-{p}")
            if self.browser.run("return cellOf(DATA.problems[arguments[0]], arguments[1])?.reached.length > 0", p, last):
                self.browser.wait(IS_DRAWN, f"#problem-{p} .curves")
        ranked = self.browser.run("return DATA.optimizers[DATA.ranked[DATA.ranked.length - 1]]")
        self.open(f"?o={ranked}#statistics")
        places = self.browser.wait("return [...document.querySelectorAll('#statistics .plot[id]')].map((one) => one.id)")
        self.assertGreaterEqual(len(places), 3)
        for place in places:
            self.browser.wait(IS_DRAWN, f"#{place}")

    def test_an_axis_has_three_ticks(self):
        for low, high in ((1.2, 1.9), (1.5, 4), (3, 90), (1.5, 180), (2, 1e9)):
            ticks = self.browser.run("return ticksOf(arguments[0], arguments[1], true)", low, high)
            self.assertGreaterEqual(len(ticks), 3, (low, high))
            self.assertTrue(all(low * (1 - 1e-6) <= tick <= high * (1 + 1e-6) for tick in ticks))

    def test_a_table_is_copied_in_three_forms(self):
        self.browser.wait(STANDINGS)
        grid = self.browser.run("return gridOf(document.getElementById('standings-table'))")
        self.assertEqual(len(grid), 1 + len(self.browser.run(
            "return [...document.querySelectorAll('#standings-table tbody tr')].map((row) => row.dataset.s)")))
        self.assertEqual(grid[0][:3], ["#", "optimizer", "score"])
        self.assertRegex(grid[1][3], r"^\d+/\d+$")
        for name, lines in (("Markdown", 1), ("CSV", 0), ("LaTeX", 4)):
            text = self.browser.run("return TABLE_TEXTS[arguments[0]](arguments[1])", name, grid)
            self.assertEqual(len(text.splitlines()), len(grid) + lines, name)
        heat = self.browser.run("return gridOf(document.getElementById('heat'))")
        self.assertEqual(len({len(row) for row in heat}), 1)
        buttons = self.browser.run("return [...document.querySelectorAll('#overview .tools button')]"
                                   ".map((one) => one.textContent)")
        self.assertGreaterEqual(buttons.count("LaTeX"), 2)

    def test_a_loss_is_not_drawn_by_when_x_was_found(self):
        p = self.problem("square")  # whose user wants x
        self.open(f"#problem-{p}")
        self.browser.wait(IS_DRAWN, f"#problem-{p} .curves")
        tolerances = self.browser.run(
            "return [...document.querySelectorAll(arguments[0])].filter((chart) => "
            "chart.querySelector('.tau') !== null).map((chart) => chart.dataset.vertical)",
            f"#problem-{p} .curves .chart")
        self.assertEqual(set(tolerances), {"x_error"})

    def test_planes_are_drawn_to_scale(self):
        p = self.problem("scaling")
        self.open(f"#problem-{p}")
        self.browser.wait(IS_DRAWN, f"#problem-{p} .plane")
        for space in (0, 1):
            across, up = self.browser.run(
                "const chart = document.querySelectorAll(arguments[0])[arguments[1]];"
                "const [x, y] = [axisOf(chart, 'x'), axisOf(chart, 'y')], area = areaOf(chart);"
                "const [, , width, height] = viewOf(area), box = boxOf(area);"
                "return [(x.high - x.low) * width / box.width, (y.high - y.low) * height / box.height]",
                f"#problem-{p} .plane .chart", space)
            self.assertAlmostEqual(across / up, 1, delta=0.02)

    def test_a_colour_is_that_of_a_kind_in_every_report(self):
        # Of the first of each kind: others are of its colour, with more ink.
        colour = ("const rule = [...document.styleSheets].flatMap((sheet) => [...sheet.cssRules]).find((one) => one.selectorText"
                  " === `[data-s=\"${DATA.optimizers.indexOf(arguments[0])}\"]`);"
                  "return rule.style.getPropertyValue('--series').match(/var\\(--[a-z-]+\\)/)[0]")
        mine = {name: self.browser.run(colour, name)
                for name in ("gd", "adam", "sip", "ceres-lm", "levenberg-marquardt")}
        self.assertEqual(mine["ceres-lm"], mine["levenberg-marquardt"])
        self.assertEqual(len(set(mine.values())), 4)
        with tempfile.TemporaryDirectory() as folder:
            run("run", "--problem", "beale,square", "--optimizer", "sip,levenberg-marquardt,gd",
                "--out", folder, "--quiet")
            self.browser.open(pathlib.Path(folder, "report", "index.html").as_uri())
            for name in ("gd", "sip", "levenberg-marquardt"):
                self.assertEqual(self.browser.run(colour, name), mine[name], name)

    def test_dash_and_marker_are_those_of_the_method_in_every_report_and_figure(self):
        look = ("const one = document.createElement('i'); one.dataset.s = DATA.optimizers.indexOf(arguments[0]);"
                "document.body.append(one); const dash = getComputedStyle(one).getPropertyValue('--dash').trim();"
                "one.remove(); return [dash, DATA.shapes[Number(one.dataset.s)]]")
        names = ("gd", "sip", "levenberg-marquardt", "ceres-lm")
        mine = {name: self.browser.run(look, name) for name in names}
        self.assertEqual(len({tuple(one) for one in mine.values()}), len(names))
        p = self.problem("beale")
        self.open(f"#problem-{p}")
        self.lines_of("beale")
        drawn = dict(self.browser.run(
            "const chart = document.querySelector('.problem.chosen .chart:not([hidden])');"
            "return [...chart.querySelectorAll('.marks .mark')].filter((mark) => mark.getAttribute('d')).map((mark) => "
            "[DATA.optimizers[mark.dataset.s], mark.getAttribute('d').match(/m[^M]*/)[0]])"))
        markers = {}  # of matplotlib, by the shape of the page
        for plot in self.json["plots"]:
            for line in plot["series"]:
                if line.get("optimizer") in mine:
                    self.assertEqual(line["dash"], mine[line["optimizer"]][0])
                    self.assertEqual(markers.setdefault(mine[line["optimizer"]][1], line["marker"]), line["marker"])
        for name in names:
            self.assertEqual(drawn[name], mine[name][1])
        self.assertEqual(len(set(markers.values())), len(markers))
        with tempfile.TemporaryDirectory() as folder:
            run("run", "--problem", "beale,square", "--optimizer", "sip,levenberg-marquardt,gd", "--out", folder, "--quiet")
            self.browser.open(pathlib.Path(folder, "report", "index.html").as_uri())
            for name in ("gd", "sip", "levenberg-marquardt"):
                self.assertEqual(self.browser.run(look, name), mine[name], name)

    # --- the race

    SCENE = "document.getElementById('motion').scrollIntoView(); if (!document.querySelector('.race')) return null;" \
            "const scene = sceneOf(arguments[0], arguments[1]); document.getElementById('motion').append(scene.svg);"

    def scene(self, script, methods=("gd", "levenberg-marquardt")):
        return self.browser.wait(self.SCENE + f"const told = (() => {{{script}}})(); scene.svg.remove(); return told;",
                                 self.problem("beale"), [self.optimizer(name) for name in methods])

    def test_the_race_is_run_by_the_run_with_the_median_work(self):
        runners = self.scene("return scene.runners", ("gd", "adam", "levenberg-marquardt", "ceres-lm"))
        self.assertEqual(len(runners), 4)
        for runner in runners:
            names = self.browser.run("return cellOf(DATA.problems[arguments[0]], arguments[1]).records", self.problem("beale"), runner["s"])
            records = [json.loads(pathlib.Path(self.folder.name, "runs", f"{name}.json").read_text()) for name in names]
            record = next(one for one in records if str(one["request"]["seed"]) == runner["seed"])
            self.assertLessEqual(set(runner["works"]), set(record["curve"]["work"]))
            self.assertEqual(runner["works"][-1], record["curve"]["work"][-1])
            taken = self.browser.run("return takenBy(cellOf(DATA.problems[arguments[0]], arguments[1]))", self.problem("beale"), runner["s"])
            self.assertEqual(runner["reached"], taken)  # both null where it is infinite

    def test_a_point_of_the_race_stands_until_the_next_one_and_a_flag_from_the_arrival_on(self):
        for share in (0, 0.3, 0.6, 1):
            seen = self.scene(
                f"const now = clockAt(scene.most, {share} * RACE_FRAMES); showWork(scene.items, now);"
                "const shown = scene.items.filter(({node}) => !node.classList.contains('off'));"
                "return [now, scene.runners.map(({s, reached, works}) => [reached, works.filter((work) => work <= now).length, "
                "shown.filter(({node}) => node.matches('.mark') && Number(node.dataset.s) === s).length, "
                "shown.filter(({node}) => node.matches('.line') && Number(node.dataset.s) === s).length]), "
                "shown.filter(({node}) => node.textContent.startsWith('⚑')).length]")
            now, runners, flags = seen
            self.assertEqual(flags, sum(reached is not None and reached <= now for reached, *_ in runners))
            for _, passed, marks, lines in runners:
                self.assertLessEqual(marks, 1)
                self.assertEqual(lines, max(0, passed - 1))

    def test_the_race_is_kept_as_frames_and_as_one_file_that_moves(self):
        frames = self.scene("const bytes = framesOf(scene); return bytes")
        self.assertEqual(len(frames), 61)
        flags = [text.count("⚑") for _, text in frames]
        self.assertEqual(flags, sorted(flags))
        self.assertGreater(flags[-1], flags[0])
        self.assertEqual(xml.etree.ElementTree.fromstring(frames[-1][1]).tag, "{http://www.w3.org/2000/svg}svg")
        packed = self.browser.call("POST", "/execute/async", {"script":
            "const done = arguments[0]; tarOf([['a.svg', 'ä'], ['b.svg', 'b'.repeat(600)]]).arrayBuffer().then((one) => "
            "done(btoa(String.fromCharCode(...new Uint8Array(one)))))", "args": []})
        with tarfile.open(fileobj=io.BytesIO(base64.b64decode(packed))) as archive:
            self.assertEqual({one.name: archive.extractfile(one).read().decode() for one in archive}, {"a.svg": "ä", "b.svg": "b" * 600})
        moving = xml.etree.ElementTree.fromstring(self.scene("return animatedText(scene)"))
        animations = list(moving.iter("{http://www.w3.org/2000/svg}animate"))
        self.assertGreater(len(animations), 20)
        for one in animations:
            times = [float(time) for time in one.get("keyTimes").split(";")]
            self.assertEqual(times[0], 0)
            self.assertEqual(times, sorted(set(times)))
            self.assertEqual(len(times), len(one.get("values").split(";")))

    def test_a_reader_who_wants_less_motion_sees_the_last_picture(self):
        for wish, is_still in (("reduce", True), ("no-preference", False)):
            self.browser.call("POST", "/goog/cdp/execute", {"cmd": "Emulation.setEmulatedMedia", "params": {
                "features": [{"name": "prefers-reduced-motion", "value": wish}]}})
            self.open("")
            self.browser.run("document.getElementById('motion').scrollIntoView()")
            self.browser.wait("return document.querySelector('.race') !== null")
            self.assertEqual(self.browser.run("return race.timer === undefined && race.frame === RACE_FRAMES"), is_still)

    def test_colours_differ_to_readers_who_see_fewer_of_them(self):
        told_apart = 20  # in Lab; 2.3 is just noticeable side by side, lines are thin and apart
        kinds = ("gradient", "adaptive", "quasi-newton", "second-order", "least-squares",
                 "half-inverse", "inversion", "derivative-free")
        for theme in ("light", "dark"):
            self.browser.run("document.documentElement.dataset.theme = arguments[0]", theme)
            palette = self.browser.run(
                "return arguments[0].map((kind) => { const place = document.querySelector('h1');"
                "place.style.color = `var(--${kind})`; const rgb = getComputedStyle(place).color"
                ".match(/\\d+/g); return '#' + rgb.map((one) => Number(one).toString(16)"
                ".padStart(2, '0')).join(''); })", kinds)
            for vision in colours.VISIONS:
                self.assertGreater(colours.least_distance(palette, vision), told_apart,
                                   f"{theme}, {vision}")

    def test_methods_of_one_kind_differ_in_colour_too(self):
        for theme in ("light", "dark"):
            self.browser.run("document.documentElement.dataset.theme = arguments[0]", theme)
            shades = self.browser.run(
                "const pixel = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});"
                "const place = document.body.appendChild(document.createElement('i'));"
                "place.style.color = 'var(--series)'; return DATA.optimizers.map((_, s) => {"
                "place.dataset.s = s; pixel.fillStyle = getComputedStyle(place).color;"
                "pixel.fillRect(0, 0, 1, 1); return '#' + [...pixel.getImageData(0, 0, 1, 1).data]"
                ".slice(0, 3).map((one) => one.toString(16).padStart(2, '0')).join(''); })")
            self.assertGreater(colours.least_distance(shades, "normal"), 6, theme)

    def test_names_at_the_ends_of_lines_can_be_read(self):
        self.open(f"#problem-{self.problem('beale')}")
        self.browser.wait(IS_DRAWN, ".problem.chosen .curves")
        self.browser.run("showLines(arguments[0], DATA.optimizers.keys())", self.problem("beale"))
        count = "return document.querySelectorAll('.problem.chosen .chart:not([hidden]) .ends text').length"
        self.browser.wait(count + " > 5")
        for theme in ("light", "dark"):
            self.browser.run("document.documentElement.dataset.theme = arguments[0]", theme)
            contrasts = self.browser.run(
                "const context = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});"
                "const luminance = (colour) => { context.fillStyle = colour; context.fillRect(0, 0, 1, 1);"
                "  const [r, g, b] = [...context.getImageData(0, 0, 1, 1).data].map((v) => v / 255)"
                "    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));"
                "  return 0.2126 * r + 0.7152 * g + 0.0722 * b; };"
                "const paper = luminance(getComputedStyle(document.body).backgroundColor);"
                "return [...document.querySelectorAll('.problem.chosen .chart:not([hidden]) .ends text')]"
                ".map((text) => luminance(getComputedStyle(text).fill)).map((ink) => "
                "(Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05))")
            self.assertGreaterEqual(min(contrasts), 4.5, theme)

    def test_a_method_that_is_chosen_is_never_folded_away(self):
        for index, optimizer in enumerate(self.json["optimizers"]):
            self.open("")
            self.browser.run("show('s', [arguments[0]])", index)
            is_ranked = optimizer["standings"]["1e-6"]["settings"] > 0
            for table in ("standings-table", "heat") if is_ranked else ("heat",):
                self.browser.run("document.getElementById(arguments[0]).scrollIntoView()", table)
                self.browser.wait(
                    "return [...document.querySelectorAll(`#${arguments[0]} tbody tr`)].filter("
                    "(row) => row.getClientRects().length > 0).map((row) => row.dataset.s).join() "
                    "=== String(arguments[1])", table, index)

    def test_a_small_selection_has_a_hue_for_each_method_in_its_order(self):
        self.open("")
        hue = "return arguments[0].map((s) => { const one = document.createElement('i'); one.dataset.s = s;" \
              "document.body.append(one); return getComputedStyle(one).getPropertyValue('--series').trim(); })"
        become = f"return JSON.stringify((function () {{ {hue} }})(arguments[0])) === JSON.stringify(arguments[1])"
        own = self.browser.run(hue, [0, 1, 2])
        first, second, third = (self.browser.run(f"return getComputedStyle(document.body).getPropertyValue('--s{i}').trim()")
                                for i in range(3))
        self.assertEqual(len({first, second, third}), 3)
        for shown, hues in (([0, 1, 2], [first, second, third]), ([1, 2], [first, second])):
            self.browser.run("show('s', arguments[0])", shown)
            self.browser.wait(become, shown, hues)
        self.browser.run("show('s', DATA.optimizers.map((_, s) => s))")
        self.browser.wait(become, [0, 1, 2], own)

    def test_a_chart_is_zoomed_turned_and_kept_as_a_file(self):
        self.open(f"#problem-{self.problem('beale')}")
        self.browser.wait(IS_DRAWN, ".problem.chosen .curves")
        chart = "const chart = document.querySelector('.problem.chosen .chart:not([hidden])');"
        ends = chart + "return [...chart.querySelectorAll('.axes text')].map((one) => one.textContent).sort()"
        whole = self.browser.run(ends)
        self.browser.run(chart + "setView(chart, 1000, 1000, 500, 500)")
        self.assertNotEqual(self.browser.run(ends), whole)
        self.browser.run(chart + "fitView(chart)")
        self.assertEqual(self.browser.run(ends), whole)
        points = "const [x, y] = [axisOf(chart, 'x'), axisOf(chart, 'y')];" \
                 "return linesOf(chart).filter(isLineShown).map((line) => pointsOf(pathOf(line))" \
                 ".map((at) => valueAt(x, at[0] / AREA)))"
        before, high = self.browser.run(chart + points), self.browser.run(chart + "return axisOf(chart, 'x').high")
        after = self.browser.run(chart + "setKind(chart, 'x', 'linear');" + points)
        for one, other in zip(before, after):
            for a, b in zip(one, other):
                self.assertAlmostEqual(a, b, delta=0.02 * a + high / 5000)  # a unit of the area
        self.browser.run(chart + "setKind(chart, 'y', 'linear'); setKind(chart, 'x', 'log'); setKind(chart, 'y', 'log')")
        self.assertEqual(self.browser.run(ends), whole)
        self.assertEqual(self.browser.run(chart + points), before)
        svg = self.browser.run(chart + "return svgText(chart)")
        self.assertEqual(xml.etree.ElementTree.fromstring(svg).tag, "{http://www.w3.org/2000/svg}svg")
        self.assertNotIn("var(", svg)
        self.assertIn('paint-order="stroke', svg)  # else the edge of a name would cover it
        for text in self.browser.run(chart + "return [nameOf(linesOf(chart).find(isLineShown)), "
                                     "chart.querySelector('title').textContent]"):
            self.assertIn(f">{text}<", svg)
        rows = self.browser.run(chart + "return csvText(chart)").splitlines()
        self.assertEqual(rows[0], "line,x,y")
        self.assertGreater(len(rows), 20)
        name, taken = self.browser.run("const s = linesShown(arguments[0]).values().next().value; return [DATA.optimizers[s], "
                                       "takenBy(cellOf(DATA.problems[arguments[0]], s))]", self.problem("beale"))
        self.assertIn(f'"{name}",{taken:g},1e-06'.replace("1e-06", "0.000001"), rows)

    def test_a_figure_opens_its_records_and_the_commands_that_repeat_it(self):
        cell = self.browser.wait(
            "const cell = document.querySelector('#heat tbody tr td[data-p].best');"
            "cell?.click(); return cell && [cell.dataset.p, cell.parentElement.dataset.s]")
        self.browser.wait("return document.getElementById('drawer').open")
        links, codes, has_curve = self.browser.run(
            "const drawer = document.getElementById('drawer');"
            "return [[...drawer.querySelectorAll('li a')].map((link) => link.href), "
            "[...drawer.querySelectorAll('code')].map((code) => code.textContent), "
            "drawer.querySelector('.spark') !== null]")
        self.assertGreater(len(links), 0)
        for link in links:
            self.assertTrue(pathlib.Path(urllib.request.url2pathname(link[7:])).exists(), link)
        self.assertTrue(codes[0].startswith("./isoline run --problem"))
        self.assertTrue(codes[1].startswith("./isoline replay "))
        self.assertTrue(has_curve, cell)
        self.browser.press("escape")
        self.browser.wait("return !document.getElementById('drawer').open")

    def test_a_run_opens_the_x_that_it_found(self):
        self.browser.run("openDrawer(arguments[0], arguments[1])", self.problem("rosenbrock"), self.optimizer("newton"))
        rows = self.browser.wait("const rows = [...document.querySelectorAll('#drawer .answer-of tr')];"
                                 "return rows.length > 0 && rows.map((row) => [...row.cells].map((cell) => cell.textContent))")
        answer = json.loads(self.records()[0].read_text())["answer"]
        self.assertEqual([row[0] for row in rows], ["unknown", "x1", "x2"])
        self.assertEqual(rows[0][1], "returned")
        for row, x in zip(rows[1:], answer["x"][0]):
            self.assertAlmostEqual(float(row[1]), x, delta=1e-7 * abs(x))
        for file in ("", "many.x.npy"):
            rest = self.browser.run(
                "const [file] = arguments, columns = file ? [] : [['unknown', 'x1', 'x2'], ['best', '1', '2']];"
                "return answerOf({answer: {seed: 0, loss: '1', unknowns: 25, file, columns}}).map((part) => part.textContent)",
                file)
            self.assertIn("25", rest[1])
            self.assertIn(file, rest[1])

    def records(self):
        """The record files that the drawer links, each of which exists."""
        links = self.browser.wait("const all = [...document.querySelectorAll('#drawer a[href$=\".json\"]')]"
                                  ".map((link) => link.href); return all.length > 0 && all")
        files = [pathlib.Path(urllib.request.url2pathname(link[7:])) for link in links]
        for file in files:
            self.assertTrue(file.exists(), file)
        return files

    def test_a_statistic_of_a_pair_opens_the_records_of_both(self):
        self.open("#statistics")
        cell = "[data-table=leader] tbody tr:nth-child(3) td:nth-child(7)"
        self.browser.run("document.querySelector(arguments[0]).click()", cell)
        heads = self.browser.run("return [...document.querySelectorAll('#drawer .settings-of th[scope=col]')]"
                                 ".slice(1).map((head) => head.innerText)")
        rows = self.browser.run("return [...document.querySelectorAll('[data-table=leader] tbody th')]"
                                ".map((name) => name.textContent)")
        self.assertEqual(heads, [rows[0], rows[2]])
        self.browser.click("#drawer .settings-of tbody tr:first-child td:nth-child(3)")
        for file in self.records():
            record = json.loads(file.read_text())
            self.assertEqual(record["request"]["optimizer"]["name"], rows[2])

    def test_failed_runs_are_those_of_the_settings_on_which_they_failed(self):
        self.open("#statistics")
        failed = self.browser.run(
            "const table = document.querySelector('[data-table=calls]'), column = "
            "[...table.tHead.rows[0].cells].findIndex((head) => head.textContent === 'failed');"
            "return [...table.tBodies[0].rows].map((row) => { row.cells[column].click();"
            "return [Number(row.cells[column].textContent.split('/')[0]), [...document.querySelectorAll("
            "'#drawer .settings-of td:last-child')].map((cell) => cell.textContent)]; })")
        for count, settings in failed:
            self.assertEqual(count, sum(int(re.search(r"(\d+) failed", text)[1]) for text in settings))

    def test_the_numbers_of_a_comparison_open_the_records_of_its_methods(self):
        self.open("?vs=gauss-newton&vs=adam&vs=ceres-lm#compare")
        self.browser.wait("return document.querySelector('#pair .prices') !== null")
        self.browser.click("#pair .bars-of li small")
        methods = {json.loads(file.read_text())["request"]["optimizer"]["name"]
                   for file in self.records()}
        self.assertEqual(methods, {"gauss-newton", "adam", "ceres-lm"})
        count = self.browser.run("return settingsOf(pair.methods.slice(0, 2)).length")
        self.browser.press("escape")
        for opener, columns in ((".verdict .evidence", 2), (".prices tbody td", 3)):
            self.browser.run("document.querySelector('#pair ' + arguments[0]).click()", opener)
            shown = self.browser.run("return [...document.querySelectorAll('#drawer .settings-of tbody tr')]"
                                     ".map((row) => row.querySelectorAll('td').length)")
            self.assertEqual(set(shown), {columns})
            if columns == 2:
                self.assertEqual(len(shown), count)

    def test_the_keyboard_reaches_what_stands_behind_a_number(self):
        self.browser.wait("return document.querySelector('#heat tbody td') !== null")
        self.browser.run("document.querySelector('#heat').parentElement.focus()")
        self.browser.press("enter", "right", "down", "enter")
        title = self.browser.wait("return document.getElementById('drawer').open && "
                                  "document.querySelector('#drawer h3').innerText")
        cell = self.browser.run("const row = [...document.querySelectorAll('#heat tbody tr')].filter((one) => "
                                "one.getClientRects().length > 0)[1], cell = row.cells[2]; return "
                                "`${DATA.optimizers[row.dataset.s]} on ${DATA.problems[cell.dataset.p].spec}`")
        self.assertEqual(title, cell)
        self.browser.press("escape")
        self.browser.wait("return document.activeElement.dataset.p === arguments[0]", self.browser.run(
            "return [...document.querySelectorAll('#heat tbody tr')].filter((one) => "
            "one.getClientRects().length > 0)[1].cells[2].dataset.p"))

    def test_the_ranking_at_other_prices_is_that_of_a_report_with_these_prices(self):
        at_prices = "return standingsAtPrices(arguments[0], arguments[1]).map(({s, score, solved}) => " \
                    "[DATA.optimizers[s], solved, score])"
        nominal = "return standingsAt(MEASURES.indexOf('work'), DEFAULT_TARGET).filter((one) => one.settings > 0)" \
                  ".map(({s, score, solved}) => [DATA.optimizers[s], solved, score])"
        for one, other in zip(self.browser.run(at_prices, 1, None), self.browser.run(nominal), strict=True):
            self.assertEqual(one[:2], other[:2])
            self.assertAlmostEqual(one[2], other[2], delta=1e-4)
        kept = {file: file.read_text() for file in pathlib.Path(self.folder.name, "components").glob("problem-*.json")}
        prices = random.Random(60)
        for gradient, jacobian in [(1.0, 1.0), *((10 ** prices.uniform(0, 3), 10 ** prices.uniform(0, 3)) for _ in range(20))]:
            expected = {name: (solved, score) for name, solved, score in self.browser.run(at_prices, gradient, jacobian)}
            for file, text in kept.items():
                sheet = json.loads(text)
                sheet["prices"] = {**sheet["prices"], "forward_seconds": 1.0, "oracles": [
                    {"oracle": name, "declared": 1, "price": value, "low": value, "high": value, "resolved": True,
                     "calls": 10, "rounds": 10} for name, value in (("pullback", gradient), ("jacobian", jacobian))]}
                file.write_text(json.dumps(sheet))
            run("report", self.folder.name, "--by", "cost", "--out", f"{self.folder.name}/priced")
            priced = json.loads(pathlib.Path(self.folder.name, "priced", "report.json").read_text())
            told = {one["optimizer"]: (one["standings"]["1e-6"]["solved"], one["standings"]["1e-6"]["score"])
                    for one in priced["optimizers"] if one["standings"]["1e-6"]["settings"] > 0}
            self.assertEqual(expected.keys(), told.keys())
            for name, (solved, score) in told.items():
                self.assertEqual(expected[name][0], solved, name)
                self.assertAlmostEqual(expected[name][1], score, delta=1e-6, msg=name)
        for file, text in kept.items():
            file.write_text(text)

    def test_prices_are_moved_by_the_keyboard_and_stay_in_the_address(self):
        self.open("#price")
        self.browser.wait("return document.querySelectorAll('.placed li').length > 1")
        self.browser.run("document.querySelectorAll('#prices input')[1].focus()")
        self.browser.press("right", "right")
        self.browser.wait("return location.search.includes('jacobian=1.12')")
        self.browser.open(self.browser.run("return location.href"))
        self.browser.wait("return document.querySelectorAll('.placed li').length > 1")
        self.assertEqual(self.browser.run("return document.querySelectorAll('#prices input')[1].value"), "1")
        took = self.browser.run("const begun = performance.now(); for (let i = 0; i < 100; ++i) standingsAtPrices(i, i);"
                                "return (performance.now() - begun) / 100")
        self.assertLessEqual(took, 50)
        for width in (1400, 390):
            resized(self.browser, width, 844)
            self.assertEqual(self.browser.run("return [...document.querySelectorAll('.placed span:first-child')]"
                                              ".filter((name) => name.scrollWidth > name.clientWidth).length"), 0, width)

    def test_the_guide_to_the_page_opens_in_it(self):
        source = pathlib.Path(__file__).parents[2] / "docs" / "reading-a-report.md"
        headings = [line[3:] for line in source.read_text().splitlines() if line.startswith("## ")]
        self.browser.click("#docs button")
        self.assertEqual(self.browser.run("return [...document.querySelectorAll('#drawer h3')]"
                                          ".map((head) => head.innerText)"), headings)
        marks = self.browser.run("return document.querySelector('#drawer .guide').innerText")
        for mark in ("**", "](", "| -", "```", "\\"):
            self.assertNotIn(mark, marks)

    # --- two methods

    def test_a_figure_of_the_ranking_opens_its_settings_and_then_their_records(self):
        self.browser.wait("return document.querySelector('#standings-table tbody td') !== null")
        self.browser.click("#standings-table tbody tr:first-child td:nth-child(5)")
        rows = self.browser.wait("return [...document.querySelectorAll('#drawer .settings-of tbody tr')]"
                                 ".map((row) => row.innerText.split('\t'))")
        count = self.browser.run(STANDINGS)[0][4]
        self.assertEqual(count, f"{sum(row[1] != '✗' and row[1] != 'n/a' for row in rows)}"
                                f"/{len(rows)}")
        self.browser.click("#drawer .settings-of tbody tr td")
        self.assertGreater(self.browser.run("return document.querySelectorAll('#drawer li a').length"),
                           2)

    def test_a_pair_has_the_figures_of_the_report(self):
        pairs = {(pair[0], pair[1]): pair[2:] for pair in self.json["pairs"]}
        names = [optimizer["optimizer"] for optimizer in self.json["optimizers"]]
        for a, b in itertools.combinations(range(len(names)), 2):
            found = self.browser.run("const one = ratioOf(...arguments); return [one.both, one.onlyA, "
                                     "one.onlyB, one.neither, one.median, one.low, one.high]", a, b)
            own = pairs[names[a], names[b]]
            self.assertEqual(found[:4], own[:4], f"{names[a]} against {names[b]}")
            for mine, other in zip(found[4:], own[4:]):
                if mine:  # 0 and infinite where both solve nothing
                    self.assertAlmostEqual(mine / other, 1, delta=1e-3)

    def test_four_methods_are_compared_and_stay_in_the_address(self):
        four = ["gauss-newton", "adam", "ceres-lm", "newton"]
        self.open("?" + "&".join(f"vs={name}" for name in four) + "#compare")
        self.browser.wait("return document.querySelectorAll('#pair select').length === 4")
        ticks = self.browser.run("return [...document.querySelectorAll('#pair .bars-of:first-of-type .axis b')]"
                                 ".map((tick) => Number(tick.textContent))")
        self.assertGreaterEqual(len(ticks), 3)
        self.assertEqual(ticks, sorted(ticks))
        rows = self.browser.run("return [...document.querySelectorAll('#pair .bars-of:first-of-type li[data-p]')]"
                                ".map((row) => row.querySelectorAll('i').length)")
        self.assertEqual(set(rows), {4})
        self.assertGreater(self.browser.run("return document.querySelectorAll('#pair .scatter "
                                            "circle').length"), 2)
        self.browser.run("writeAddress()")
        self.assertEqual(self.browser.run("return new URLSearchParams(location.search)"
                                          ".getAll('vs')"), four)

    # --- three readers

    def test_a_student_learns_whether_sip_is_better_than_adam_and_at_what_price(self):
        self.browser.click("nav a[href='#compare']")  # one click: sip against adam stand there
        sentence = self.browser.wait("return document.querySelector('#pair .verdict')?.innerText")
        self.assertRegex(sentence, r"sip.* adam .* \d to 1e-6")
        prices = self.browser.run("return document.querySelector('#pair .prices').innerText")
        for word in ("forward solves", "wall time", "required derivatives", "extra information"):
            self.assertIn(word, prices)
        self.assertLess(self.browser.run(SCREENS_DOWN, "#pair .prices"), 2)
        self.browser.click("#pair .bars-of a")  # a second: the curves of these two
        self.browser.wait(IS_DRAWN, ".problem.chosen .curves")
        self.browser.wait("return linesOf(document.querySelector('.problem.chosen .chart:not([hidden])'))"
                          ".filter(isLineShown).length === 2")
        drawn = [name for name, _ in self.browser.run(LINES, ".problem.chosen .curves")]
        two = self.browser.run("return pair.methods.map((s) => DATA.optimizers[s])")
        self.assertEqual(sorted(drawn), sorted(two))

    def test_an_engineer_with_forward_solves_alone_finds_a_method_in_two_clicks(self):
        self.browser.click("nav a[href='#choose']")
        place = "#means .switch:nth-child({}) button:nth-of-type({})"
        self.browser.wait("return document.querySelector('#means .answer .verdict') !== null")
        method = "return document.querySelector('#means .answer tbody th')?.innerText.trim()"
        self.assertEqual(self.browser.run(method), "nlopt-bobyqa")
        self.browser.click(place.format(4, 3))  # all problems have few unknowns
        self.assertEqual(self.browser.run(method), "nlopt-bobyqa")
        self.assertEqual(self.browser.run("return Object.fromEntries(new URLSearchParams("
                                          "location.search))"), {"budget": "1000"})
        self.browser.click(place.format(1, 3))
        self.assertNotEqual(self.browser.run(method), "nlopt-bobyqa")
        self.browser.open(self.browser.run("return location.href"))
        self.assertEqual(self.browser.wait("return means.level === 2 && means.budget"), 2)

    def test_the_page_fits_a_phone(self):
        resized(self.browser, 400, 800)
        for tab in ("overview", "choose", "compare", "problems", "methods", "statistics", "runs"):
            self.open(f"#{tab}")
            wide = self.browser.run(WIDER)
            self.assertLessEqual(wide, 0, f"{tab} is wider than the window")
            self.assertLessEqual(self.browser.run("return document.querySelector('.bars')"
                                                  ".offsetHeight"), 105)
            right, letters = self.browser.run(
                "const all = [...document.querySelectorAll('.tab.open .chart')].filter((chart) => "
                "chart.getClientRects().length > 0); return [Math.max(0, ...all.map((chart) => "
                "areaOf(chart).getScreenCTM() && chart.querySelector('.axes').getBoundingClientRect().right)),"
                "Math.min(99, ...all.map((chart) => parseFloat(getComputedStyle(chart).fontSize) * "
                "chart.getBoundingClientRect().width / chart.viewBox.baseVal.width))]")
            self.assertLessEqual(right, 400, f"a chart of {tab} leaves the window")
            self.assertGreaterEqual(letters, 9, "pixels")

    def test_paper_has_the_open_tab_drawn(self):
        for tab in ("overview", "problems", "statistics"):
            self.open(f"#{tab}")
            self.browser.wait("return TASKS.size === 0")
            paper = base64.b64decode(self.browser.call("POST", "/print", {}))
            self.assertLessEqual(len(re.findall(rb"/Type\s*/Page\b", paper)), 12, tab)
            left = self.browser.run("return document.getElementById('left-out').textContent")
            self.assertEqual(left.count(","), 6, left)  # a comma in the sentence, five among six tabs
        self.assertTrue(self.browser.run(
            "return [...document.querySelectorAll('.tab.open .chart')].every((chart) => "
            "linesOf(chart).length > 0)"))


class Workers(InBrowser):
    """Methods that hand several forward solves over at once, and others."""

    @classmethod
    def made(cls, folder):
        run("run", "--problem", "rosenbrock,burgers[N=8],poisson[N=8]", "--optimizer", "cma-es,dfo-gn,gd,ceres-lm", "--seeds", "2",
            "--work", "2000", "--rates", "none", "--out", folder, "--quiet")
        cls.results = pathlib.Path(folder)
        return pathlib.Path(folder, "report", "index.html")

    def test_workers_share_the_rounds_that_records_count(self):
        counted, shared = set(), 0
        for file in (self.results / "runs").glob("*.json"):
            record = json.loads(file.read_text())
            for columns in (record["curve"], record.get("hits", {}), record.get("x_hits", {})):
                counted.update(zip(columns.get("work", []), columns.get("rounds", {}).get("64", [])))
        self.open("")
        calls = self.browser.run("return DATA.calls.map(([, methods]) => methods)")
        for flat in (flat for methods in calls for flat in methods):
            for work, gradients, jacobians, _, rounds in zip(*[iter(flat)] * 5):
                if work != rounds:
                    self.assertEqual((gradients, jacobians), (0, 0))
                    self.assertIn((work, rounds), counted)
                    shared += 1
        self.assertGreater(shared, 0)
        self.open("?workers=64#price")
        self.browser.wait("return document.querySelectorAll('.placed li').length > 1")
        marked = self.browser.run("return [...document.querySelectorAll('.placed li')].map((row) => "
                                  "row.innerText.includes('one call'))")
        self.assertEqual(sorted(set(marked)), [False, True])


class Forward(InBrowser):
    """The suite for simulators without derivatives."""

    @classmethod
    def made(cls, folder):
        run("run", "quick-forward", "--out", folder, "--quiet")
        return pathlib.Path(folder, "report", "index.html")

    def test_without_a_race_the_share_of_solved_settings_stands_beside_the_ranking(self):
        self.open("")
        self.browser.wait("return document.querySelector('#standings-table td')")
        place = self.browser.run("const {top, bottom} = document.querySelector('#plot-first svg').getBoundingClientRect();"
                                 "return [document.getElementById('motion').childElementCount, top, bottom]")
        self.assertEqual(place[0], 0)
        self.assertTrue(0 < place[1] < place[2] < 900, place)

    def test_paper_has_all_columns_of_the_matrix(self):
        self.open("")
        self.browser.wait("return document.querySelector('#heat td') !== null")
        resized(self.browser, 703, 900)  # the width of A4, upright
        try:
            self.browser.call("POST", "/goog/cdp/execute", {"cmd": "Emulation.setEmulatedMedia", "params": {"media": "print"}})
            seen = self.browser.run(
                "dispatchEvent(new Event('beforeprint')); return [...document.querySelectorAll('.matrix thead th[data-p]')]"
                ".map((one) => one.getBoundingClientRect()).filter((box) => box.width > 0 && box.right <= innerWidth).length")
            self.assertEqual(seen, self.browser.run("return DATA.problems.length"))
            self.browser.run("dispatchEvent(new Event('afterprint'))")
        finally:
            self.browser.call("POST", "/goog/cdp/execute", {"cmd": "Emulation.setEmulatedMedia", "params": {"media": ""}})

    def test_names_of_columns_can_be_told_apart(self):
        names = self.browser.run("return DATA.problems.map(brief)")
        self.assertEqual(len(set(names)), len(names))
        self.assertLessEqual(max(map(len, names)), 24)

    def test_settings_whose_calls_fail_are_a_kind_of_their_own(self):
        self.open("#choose")
        self.browser.wait("return document.querySelector('#means .answer .verdict')")
        self.assertEqual(self.browser.run("return DATA.dataKinds.map((_, kind) => adviceFor({...means, kind})[1])"), [8, 8, 8])

    def test_an_engineer_with_noisy_data_finds_method_runs_and_certainty_in_two_clicks(self):
        self.open("")
        self.browser.click(".ways a[href='#choose']")
        self.browser.wait("return document.querySelector('#means .answer .verdict')")
        self.assertIn("10", self.browser.run("return document.querySelector('#means > p').innerText"))
        self.browser.click("#means .switch:nth-child(5) button:nth-of-type(2)")
        verdict = self.browser.run("return document.querySelector('#means .verdict').innerText")
        self.assertRegex(verdict, r"1 % noise.*use [\w-]+\..* \d+ forward solves\. .*significantly")


class Whole(InBrowser):
    """Problems of every kind: each number of each tab opens what stands behind it."""

    @classmethod
    def made(cls, folder):
        run("run", "--problem", "rosenbrock,helical-valley,poisson,heat,burgers,nist[dataset=Misra1a],"
            "sine[xi=32,mode=learn]", "--optimizer", "gd,adam,sip,gauss-newton,ceres-lm", "--seeds", "2",
            "--iterations", "40", "--out", folder, "--quiet")
        return pathlib.Path(folder, "report", "index.html")

    def test_learned_columns_are_on_screen_beside_as_many_others_as_the_default_suite_has(self):
        for width in (1400, 1920):
            resized(self.browser, width, 900)
            self.open("")
            self.browser.wait("return TASKS.size === 0 && document.querySelector('#heat td') !== null")
            ends = self.browser.run(
                "const like = (group) => DATA.problems.find((one) => one.group === group);"
                "for (const [group, count] of [['physics', 18], ['classical', 20]])"
                "  for (let i = 0; i < count; ++i) DATA.problems.push({...like(group)});"
                "drawHeat(document.getElementById('heat'));"
                "const heads = [...document.querySelectorAll('#heat thead th[data-p]')];"
                "return heads.filter((head) => DATA.problems[head.dataset.p].learned !== undefined)"
                ".map((head) => head.getBoundingClientRect().right)")
            self.assertGreater(len(ends), 0)
            self.assertLessEqual(max(ends), width)

    def test_a_pair_is_compared_on_learned_problems_whatever_a_method_was_given_there(self):
        self.open("#compare")
        link = self.browser.wait("return document.querySelector('#pair a[title=\"sine[xi=32,mode=learn]\"]') !== null")
        self.assertTrue(link)
        named = self.browser.run("return pair.methods.map((s) => DATA.optimizers[s])")
        self.assertNotIn("sip, given the exact Hessian", named)

    def test_every_error_of_a_learned_problem_says_where_it_is_read(self):
        self.open("")
        self.browser.wait("return document.querySelector('#heat td') !== null")
        heads = self.browser.run(HEADS)
        p = self.browser.run("return DATA.problems.findIndex((one) => one.learned !== undefined)")
        self.open(f"#problem-{p}")
        self.browser.wait("return document.querySelector('.problem.chosen .reached td') !== null")
        self.browser.run("const part = document.getElementById('learned'); part.open = true; unpackAll(part)")
        heads += self.browser.run(HEADS)
        self.assertGreaterEqual(len(heads), 3)
        for head in heads:
            self.assertRegex(head, "equal work|at the end|final")

    def test_every_number_of_a_table_opens_its_evidence(self):
        counts = {}
        for tab in ("overview", "problems", "methods", "statistics", "runs"):
            self.open(f"#{tab}")
            self.browser.wait("return TASKS.size === 0 && document.querySelector('#heat td') !== null"
                              if tab == "overview" else "return TASKS.size === 0")
            counts[tab], silent = self.browser.run(SILENT, tab)
            self.assertEqual(silent, [], tab)
        self.assertGreater(counts["overview"], 40)
        self.assertGreater(counts["statistics"], 150)


class Real(InBrowser):
    """Problems with noise, bounds and a penalty."""

    @classmethod
    def made(cls, folder):
        run("run", "--problem", "burgers[N=8|16|32],burgers[N=8|16|32,bounds=active],"
            "burgers[N=8,noise=0.05],burgers[N=8,noise=0.05,tikhonov=1e-5|1e-4|1e-3|1e-2|1e-1]",
            "--optimizer", "gd,ceres-lm,levenberg-marquardt", "--target", "0", "--iterations", "100",
            "--out", folder, "--quiet")
        return pathlib.Path(folder, "report", "index.html")

    def test_every_number_on_penalties_sizes_and_noise_opens_its_evidence(self):
        self.open("#statistics")
        self.browser.wait("return TASKS.size === 0")
        _, silent = self.browser.run(SILENT, "statistics")
        self.assertEqual(silent, [])
        shown = self.browser.run("return [...document.querySelectorAll('#statistics table')]"
                                 ".map((one) => one.dataset.table)")
        for table in ("features", "l-curve", "size", "discrepancy"):
            self.assertIn(table, shown)

    def test_the_chooser_offers_the_kinds_of_data_of_the_study(self):
        self.open("#choose")
        verdict = "return document.querySelector('#means .answer .verdict')?.innerText"
        self.browser.wait(verdict)
        kinds, answers = self.browser.run("return DATA.dataKinds"), set()
        for i, kind in enumerate(kinds):
            self.browser.click(f"#means .switch:nth-child(5) button:nth-of-type({i + 1})")
            answers.add(self.browser.run(verdict))
            asked = self.browser.run("return new URLSearchParams(location.search).get('data')")
            self.assertEqual(asked, kind if i > 0 else None)
        self.assertEqual(len(answers), 3, "exact, noisy and bounded data")
        self.browser.open(self.browser.run("return location.href"))
        self.assertEqual(self.browser.wait("return means.kind"), 2)


class Learned(unittest.TestCase):
    """A report of learned problems alone uses the error in x."""

    def test_it_opens_with_who_is_nearest_in_x(self):
        with tempfile.TemporaryDirectory() as folder:
            run("run", "--problem", "sine[xi=32,mode=learn]", "--optimizer",
                "adam,gd,sip[inverse=newton]", "--iterations", "30", "--out", folder, "--quiet")
            page = browser.Browser()
            try:
                page.open(pathlib.Path(folder, "report", "index.html").as_uri())
                verdict = page.run("return document.querySelector('.verdict').innerText")
                self.assertIn("at equal work", verdict)
                self.assertIn("errors in x over", verdict)
                heat = page.wait("return document.querySelector('#heat').innerText")
                self.assertIn("learned: error in x", heat)
                self.assertIn("ranked by work",
                              page.run("return document.getElementById('overview').innerText"))
                cells = page.run("return [...document.querySelectorAll('#heat td[data-p]')]"
                                 ".map((cell) => cell.innerText)")
                self.assertTrue(all(float(cell) > 0 for cell in cells), cells)
                page.open(pathlib.Path(folder, "report", "index.html").as_uri() + "#problem-0")
                page.wait(IS_DRAWN, "#problem-0 .curves")
                caption = page.run("return document.querySelector('.reached caption').innerText")
                self.assertIn("error in x", caption)
                self.assertTrue(page.run(
                    "const chart = document.querySelector('.chart[data-vertical=x_error]');"
                    "return linesOf(chart).every((line) => line.querySelector('.points') !== null"
                    " && pathOf(line).getAttribute('d').includes('l'))"), "joined, and marked")
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()


class Claims(unittest.TestCase):
    """From a verdict to its evidence in one click."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        claims = ["notebook-gd-table", "notebook-newton-distance", "notebook-start-loss",
                  "exponential-rescaled-over-adam", "sine-ill-conditioned-gd"]
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
                resized(page, *size)
                page.open(self.address + "#claims")
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
                wide = page.run(WIDER)
                self.assertLessEqual(wide, 0, "the page is wider than the window")
                self.assertEqual(page.complaints(), [])
            finally:
                page.close()

    def test_a_browser_that_cannot_decompress_shows_what_needs_no_scripts(self):
        page = browser.Browser()
        try:
            page.call("POST", "/goog/cdp/execute", {
                "cmd": "Page.addScriptToEvaluateOnNewDocument",
                "params": {"source": "delete window.DecompressionStream"}})
            page.call("POST", "/url", {"url": self.address})
            page.wait("return document.querySelector('noscript') === null")
            seen = page.run("return ['#overview > .scroll tr', '.tab', '#overview > .alert'].map((selector) => "
                            "[...document.querySelectorAll(selector)].length)")
            self.assertTrue(all(count > 0 for count in seen), seen)
            self.assertIn("report.md", page.run("return document.querySelector('#overview > .alert').innerText"))
            self.assertEqual(page.run("return [...document.querySelectorAll('.tab')].filter((tab) => "
                                      "tab.getClientRects().length === 0).length"), 0)
            self.assertEqual(page.complaints(), [])
        finally:
            page.close()

    def test_the_first_tab_counts_the_verdicts(self):
        page = browser.Browser()
        try:
            page.open(self.address)
            counts = re.findall(r"\d+", page.run("return document.querySelector('.checked').textContent"))
        finally:
            page.close()
        strength = ("too short", "undecidable", "not comparable", "reproduced", "agrees", "partly", "too noisy",
                    "one run", "differs")
        facts = {}  # the weakest decided verdict of each
        for claim in self.json["claims"]:
            if not claim["verification"]:
                facts[claim["fact"]] = max(facts.get(claim["fact"], claim["verdict"]), claim["verdict"],
                                           key=strength.index)
        groups = (("reproduced",), ("agrees",), ("differs",), ("partly", "too noisy", "one run"),
                  ("too short", "undecidable", "not comparable"))
        self.assertGreater(int(counts[0]), 0)
        self.assertEqual([int(count) for count in counts],
                         [sum(verdict in group for verdict in facts.values()) for group in groups])

    def test_a_published_result_stands_below_the_ranking_with_its_interval(self):
        page = browser.Browser()
        try:
            resized(page, 1400, 900)
            page.open(self.address)
            page.run("document.querySelector('.first figure').scrollIntoView()")
            hero = page.run("const hero = document.querySelector('.first figure'); return hero && "
                            "[hero.innerText, hero.querySelector('.ground') !== null, "
                            "hero.querySelector('figcaption').getBoundingClientRect().left, hero.querySelectorAll('.tools button').length]")
        finally:
            page.close()
        self.assertIsNotNone(hero)
        text, has_interval, left, tools = hero
        self.assertTrue(has_interval)
        self.assertGreaterEqual(tools, 5)
        self.assertGreater(left, 700)
        self.assertRegex(text, r"Measured: [\d.]+ \(bar: [\d.]+ to [\d.]+ ")

    def test_a_number_of_a_claim_opens_its_records(self):
        page = browser.Browser()
        try:
            page.open(self.address + "#claims")
            decided = [claim["id"] for claim in self.json["claims"] if claim["sets"]]
            for claim in decided:
                page.run("document.querySelector(arguments[0]).click()",
                         f'#claims tr[data-claim="{claim}"] td:nth-child(4)')
                links = page.run("return [...document.querySelectorAll('#drawer td a')].map((link) => link.href)")
                self.assertGreater(len(links), 0, claim)
                for link in links:
                    self.assertTrue(pathlib.Path(urllib.request.url2pathname(link[7:])).exists(), link)
                self.assertIn(claim, page.run("return document.querySelector('#drawer code').innerText"))
            page.open("about:blank")
            page.open(f"{self.address}#claim-{decided[0]}")
            page.wait("return [...document.querySelectorAll('.claim[open] td a')].some((link) => "
                      "link.getClientRects().length > 0)")
        finally:
            page.close()

    def test_records_are_linked_and_the_command_repeats_the_claim(self):
        page = browser.Browser()
        try:
            page.open(self.address + "#claims")
            page.run("document.querySelectorAll('details.claim').forEach(unpack)")
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
