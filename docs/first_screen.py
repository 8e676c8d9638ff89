#!/usr/bin/env python3
"""Writes the findings and the animated picture on the first screen of README.md.

    ./isoline run quick
    python3 docs/first_screen.py results/quick

The findings come from benchmarks/published/contest.csv.xz and contest-tuned.csv.xz, and from report/report.json in the
result folder; they replace the text between the two markers in README.md. The picture, docs/heat.svg, animates x of `heat` over forward solves, from the
snapshots in three records.
"""

import base64
import csv
import json
import lzma
import math
import pathlib
import re
import statistics
import struct
import sys
import textwrap
import zlib

import numpy
from scipy import stats

ROOT = pathlib.Path(__file__).resolve().parent.parent
METHODS = {"adam": "Adam", "levenberg-marquardt-cg": "Levenberg–Marquardt", "sip": "SIP"}
SUITE = json.loads((ROOT / "benchmarks/suites/contest.json").read_text())
MARGIN = math.log(1.1, 64)  # 10 % in work, as a difference of scores
REMARKS = {"adam": " at its default rate of 10⁻³, which was not tuned"}
COUNTS = {1: "contrast was", 2: "two contrasts were", 3: "three contrasts were"}
FRAMES, SECONDS, SIDE = 24, 8, 150


def png(rows, low, high):
    """A data URI of an image (rows, columns) from blue over white to red."""

    def color(value):
        t = min(max((value - low) / (high - low), 0.0), 1.0)
        cold, warm = min(2 * t, 1.0), min(2 - 2 * t, 1.0)
        return bytes((round(255 * cold), round(255 * min(cold, warm)), round(255 * warm)))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    raw = b"".join(b"\0" + b"".join(map(color, row)) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    data = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw, 9))
    return "data:image/png;base64," + base64.b64encode(data + chunk(b"IEND", b"")).decode()


def planes(path):
    """The float32 arrays (rows, columns) of a .npy file of the shape (planes, rows, columns)."""
    data = path.read_bytes()
    begin = 10 + struct.unpack("<H", data[8:10])[0]
    count, rows, columns = map(int, re.search(rb"\((\d+), (\d+), (\d+)\)", data[:begin]).groups())
    numbers = struct.unpack(f"<{count * rows * columns}f", data[begin:])
    return [[numbers[(p * rows + r) * columns:(p * rows + r + 1) * columns] for r in range(rows)]
            for p in range(count)]


def heat_records(results):
    """By method, the record of `heat` at seed 0 and its snapshots."""
    found = {}
    for path in sorted((results / "runs").glob("*.json")):
        record = json.loads(path.read_text())
        request = record["request"]
        name = request["optimizer"]["name"]
        if request["problem"]["spec"] == "heat" and request["seed"] == 0 and name in METHODS:
            found[name] = (record, planes(path.with_suffix(".npy")))
    missing = METHODS.keys() - found.keys()
    if missing:
        sys.exit(f"{results}: no snapshots of heat by {', '.join(sorted(missing))}; "
                 "make them with: ./isoline run quick")
    return found


def panel(column, title, images, visible):
    """Images of one panel. `visible` lists the frames that show each image; an empty entry means all frames."""
    x = 10 + column * (SIDE + 14)
    out = [f'<text x="{x + SIDE / 2}" y="20" text-anchor="middle" font-weight="600">{title}</text>']
    for image, frames in zip(images, visible):
        out.append(f'<image x="{x}" y="30" width="{SIDE}" height="{SIDE}" href="{image}" '
                   f'style="image-rendering:pixelated">{animation(frames)}</image>')
    return out


def animation(frames):
    if not frames:
        return ""
    shown = ";".join("1" if frame in frames else "0" for frame in range(FRAMES))
    return (f'<animate attributeName="opacity" calcMode="discrete" dur="{SECONDS}s" '
            f'repeatCount="indefinite" values="{shown}"/>')


def picture(results):
    found = heat_records(results)
    target, truth = next(iter(found.values()))[1][:2]
    low, high = min(map(min, truth)), max(map(max, truth))
    parts = panel(0, "observed y*", [png(target, low, high)], [()])
    parts += panel(1, "unknown x*", [png(truth, low, high)], [()])
    most = max(record["summary"]["work"] for record, _ in found.values())
    works = [round(math.exp(math.log(most) * frame / (FRAMES - 4))) for frame in range(FRAMES)]
    norm = math.sqrt(sum(v * v for row in truth for v in row))
    for column, (name, title) in enumerate(METHODS.items(), 2):
        record, arrays = found[name]
        work_at = dict(zip(record["curve"]["iteration"], record["curve"]["work"]))
        done = [work_at[i] for i in record["fields"]["iterations"]]
        latest = [max(i for i, work in enumerate(done) if work <= max(now, done[0])) for now in works]
        shown = [{f for f in range(FRAMES) if latest[f] == i} for i in range(len(done))]
        parts += panel(column, title, [png(x, low, high) for x in arrays[2:]], shown)
        for x, frames in zip(arrays[2:], shown):
            error = math.sqrt(sum((a - b) ** 2 for r, s in zip(x, truth) for a, b in zip(r, s))) / norm
            place = 10 + column * (SIDE + 14) + SIDE / 2
            parts.append(f'<text x="{place}" y="{SIDE + 48}" text-anchor="middle" opacity="0">'
                         f'error {100 * error:.0f} %{animation(frames)}</text>')
    for frame, work in enumerate(works):
        parts.append(f'<text x="10" y="{SIDE + 48}" opacity="0">{min(work, most)} forward solves'
                     f'{animation({frame})}</text>')
    width, height = 6 + 5 * (SIDE + 14), SIDE + 60
    (ROOT / "docs/heat.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">\n'
        f'<rect width="{width}" height="{height}" fill="#fff"/>\n' + "\n".join(parts) + "\n</svg>\n")


def sine_at_equal_work(report):
    """The error in x of adam over that of sip, its interval, and on how many seeds it is larger, as the tab Overview states them."""
    for sentence in report["verdict"]:
        match = re.match(r"sine\[.*\bsip\b.*smallest error in x.*; adam is next, with an error ([\d.]+)× as large "
                         r"\(([\d.]+) to ([\d.]+), 95 %; larger on (\d+ of \d+) seeds\)", sentence)
        if match:
            return match.groups()
    sys.exit("report.json: no sentence on the error in x of sip and adam on the learned sine; "
             "make it with: ./isoline run quick")


def contest_works(name="contest"):
    """Work to 1e-6 of each published run of a suite by setting and method: of nonlinear problems without added noise."""
    blocks = [block for block in SUITE["matrix"] if block["comment"].startswith("A") and "features" not in block]
    names = {name_of(problem) for block in blocks for problem in block["problems"]}
    works = {}
    with lzma.open(ROOT / f"benchmarks/published/{name}.csv.xz", "rt") as table:
        for row in csv.DictReader(table):
            if name_of(row["problem"]) in names and "noise=" not in row["problem"]:
                works.setdefault(row["problem"], {}).setdefault(name_of(row["optimizer"]), []).append(float(row["work_to_1e-6"]))
    return works


def name_of(spec):  # that of a problem is its family here
    return spec.partition("[")[0]


def interval_of(differences):
    """95 % t interval of the mean over families and two pseudo-families, which is the last axis."""
    ends = numpy.broadcast_to([-1.0, 1.0], (*numpy.shape(differences)[:-1], 2))
    values = numpy.concatenate([differences, ends], axis=-1)
    n = values.shape[-1]
    half = stats.t.ppf(0.975, n - 1) * values.std(axis=-1, ddof=1) / math.sqrt(n)
    return values.mean(axis=-1), values.mean(axis=-1) - half, values.mean(axis=-1) + half


def detectable_factor(families, deviation):
    """The least factor in work that is found in 80 % of simulated data sets."""
    noise = deviation * numpy.random.default_rng(0).standard_normal((4000, families))
    return next((factor for factor in (2, 3, 4, 5, 6, 8, 16, 32, 64)
                 if numpy.mean(interval_of(numpy.clip(noise + math.log(factor, 64), -1, 1))[1] > MARGIN) >= 0.8), None)


def contrasted(works):
    """The contrasts in their order, until one shows no better method: for each the better method, the other one, the interval of the
    difference of their scores, the differences by family, and the settings that each solves."""
    methods = sorted({method for pair in SUITE["contrasts"] for method in pair})
    costs = {p: {m: statistics.median(works[p][m]) for m in methods} for p in works}
    families = sorted(set(map(name_of, works)))

    def score(method, family):  # 1 less the doublings of work over the least, in units of six
        own = [costs[p] for p in works if name_of(p) == family]
        return statistics.mean(max(0, 1 - math.log(max(each[method], 1) / max(min(each.values()), 1), 64))
                               if each[method] < math.inf else 0 for each in own)

    for first, second in SUITE["contrasts"]:
        differences = [score(first, family) - score(second, family) for family in families]
        mean, low, high = interval_of(differences)
        if mean < 0:
            first, second, low, high, differences = second, first, -high, -low, [-d for d in differences]
        yield first, second, low, high, differences, {m: {p for p in works if costs[p][m] < math.inf} for m in (first, second)}
        if low <= MARGIN:
            return


def tuned_finding():
    """What the methods of the contrasts solve with tuned rates; nothing is tested a second time."""
    works = contest_works("contest-tuned")
    count = lambda method: sum(statistics.median(works[p][method]) < math.inf for p in works)
    solved = [f"{method} {count(method)}" for method in dict.fromkeys(m for pair in SUITE["contrasts"] for m in pair)]
    spent = next(row["source"]["spent"] for row in json.loads((ROOT / "benchmarks/rates/contest-tuned.json").read_text())["rows"]
                 if row["optimizer"] == "adam")
    return (f"With rates tuned on the other families (`contest-tuned`; for adam, by {spent / 1e6:.2g} million forward "
            f"solves), which is described and not tested, the settings solved of {len(works)} are: {', '.join(solved)}.")


def contest_findings():
    """A paragraph, a finding for each contrast that is tested, what was not tested, and the same with tuned rates."""
    works, contrasts = contest_works(), SUITE["contrasts"]
    families = sorted(set(map(name_of, works)))
    items, deviation = [], 0
    for tested, (first, second, low, high, differences, solved) in enumerate(contrasted(works), 1):
        deviation = statistics.stdev(differences)
        missed = [sum(w == math.inf for p in works for w in works[p][m]) for m in (first, second)]
        runs = sum(len(works[p][first]) for p in works)
        if low > MARGIN:
            items.append(f"{first} is better than {second}{REMARKS.get(second, '')}: {second} solves {len(solved[second]) or 'none'} of "
                         f"{len(works)} settings within its budget, {first} {len(solved[first])}; {missed[1]} and {missed[0]} of "
                         f"{runs} runs miss 10⁻⁶.")
            continue
        back = len(solved[second] - solved[first])
        items.append(f"{first} has the higher score in {sum(d > 0 for d in differences)} of {len(families)} families and solves "
                     f"{len(solved[first] - solved[second])} settings that {second} does not, {back or 'none'} the other way. The 95 % interval "
                     f"of its relative work (64^−Δscore; with two pseudo-families at ±64-fold), {64 ** -high:.2f} to {64 ** -low:.2f}, "
                     "does not exclude equality.")
        if tested < len(contrasts):
            items[-1] += f" The other {COUNTS[len(contrasts) - tested]} thus not tested."
    items.append(tuned_finding())
    usual, here = (f"a factor of {factor}" if factor else "no factor"
                   for factor in (detectable_factor(len(families), d) for d in (0.25, deviation)))
    lead = (f"**Findings** from the suite `contest`: eight methods, named before the runs, at their defaults, on {len(families)} families "
            f"of nonlinear problems without added noise ({runs} runs per method), chosen and not sampled. Contrasts are tested in their "
            f"order, each at 5 %, until one shows no better method. If scores differ between families with a standard deviation of 0.25, "
            f"{usual} in work is found with a probability of 80 %; at {deviation:.2f}, as in the last contrast tested, {here}.")
    return lead, items


def findings(report):
    """The finding on the default suite, with numbers from report.json."""
    leader = report["leader"]
    first = leader["places"][0]
    sine = next(cell for cell in report["cells"]
                if cell["problem"].startswith("sine[") and cell["optimizer"].startswith("sip"))
    times, low, high, seeds = sine_at_equal_work(report)
    decision = (f"{first['optimizer']} is significantly ahead of every other method" if leader["significant"] else
                "no result could be significant" if leader["families"] < 6 else "no method is significantly ahead of all others")
    return (f"In `quick`, a sample for a first look ({len(leader['places'])} methods, {leader['settings']} settings of "
            f"{leader['families']} families), {decision}. On sine, networks trained by adam "
            f"end with {times} times the error in x of those trained by sip (95 %: {low} to {high}; more on "
            f"{seeds} seeds), at published rates and equal work in physics alone. sip (†) is given "
            f"{sine['optimizer'].partition(', given ')[2]}.")


def write_findings(quick):
    """Replaces the findings in README.md."""
    readme = ROOT / "README.md"
    before, rest = readme.read_text().split("<!-- findings -->\n")
    after = rest[rest.index("<!-- end of findings -->"):]
    lead, items = contest_findings()
    items.append(findings(json.loads((quick / "report.json").read_text())))
    text = textwrap.fill(lead, 120, break_on_hyphens=False) + "\n" + "".join(
        textwrap.fill(each, 120, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False) + "\n" for each in items)
    readme.write_text(before + "<!-- findings -->\n" + text + after)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    results = pathlib.Path(sys.argv[1])
    picture(results)
    write_findings(results / "report")
