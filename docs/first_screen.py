#!/usr/bin/env python3
"""Writes the findings and the animated picture on the first screen of README.md.

    ./isoline run contest && ./isoline run quick
    python3 docs/first_screen.py results/quick results/contest

The findings come from report/report.json in the two result folders and replace the text between the
two markers in README.md. The picture, docs/heat.svg, animates x of `heat` over forward solves, from the
snapshots in three records.
"""

import base64
import json
import math
import pathlib
import re
import struct
import sys
import textwrap
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
METHODS = {"adam": "Adam", "levenberg-marquardt-cg": "Levenberg–Marquardt", "sip": "SIP"}
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


def table_of(report, key):
    """The rows of a table, each a dictionary by column."""
    for section in report["sections"]:
        for table in section.get("tables", []):
            if table["id"] == key:
                return [dict(zip(table["columns"], row)) for row in table["rows"]], table["reading"]
    sys.exit(f"report.json: no table {key}; make it with: ./isoline run contest")


def contest_findings(report):
    """A paragraph and a finding for each contrast, with numbers from report.json."""
    rows, reading = table_of(report, "contrasts")
    if len(rows) < 2:
        sys.exit(f"report.json of contest: {reading}")
    families = re.search(r"on (\d+) (?:family|families)", reading)[1]
    runs = rows[0]["failures of the first"].split(" (")[0].split("/")[1]
    powers = re.findall(r"(a factor of [\d.]+|no factor)(?: in work| up to)", reading)
    here = re.search(r"; with ([\d.]+), that of the last contrast", reading)[1]
    lead = (f"**Findings** from the suite `contest`: eight methods, named before the runs, at their defaults, on {families} families of "
            f"nonlinear problems with exact data ({runs} runs per method), chosen and not sampled. Contrasts are tested in their order, "
            f"each at 5 %, until one finds no difference. If scores differ between families with a standard deviation of 0.25, {powers[0]} "
            f"in work is found with a probability of 80 %; at {here}, as in the second contrast, {powers[-1]}.")
    items = []
    for row in rows:
        if row["contrast"].endswith("with noise") or "not tested" in row["decision"]:
            continue
        first, second = row["contrast"].split(" against ")
        failures = [row[f"failures of the {which}"].split(" (")[0].replace("/", " of ") for which in ("first", "second")]
        ratio, both = row["both solve"].rstrip(")").split(" (")
        none = re.search(rf"where (\S+) solves none of (\d+ settings)", reading)
        if both == "0" and none:
            items.append(f"{row['decision']}: {none[1]} solves none of {none[2]} within its budget, so no ratio of work is known; "
                         f"{failures[0].split()[0]} and {failures[1]} runs miss 10⁻⁶.")
            continue
        index = row["index"].replace(" (", " (95 %: ", 1)
        items.append(f"{row['decision'].replace('the families', 'The families')}, by a rule stricter than 5 %: index of work "
                     f"{index}; where both solve ({both} settings), {ratio} times the work; {failures[0].split()[0]} and "
                     f"{failures[1]} runs miss 10⁻⁶.")
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
            f"end with about {float(times):.2g} times the error in x of those trained by sip (95 %: {low} to {high}; more on "
            f"{seeds} seeds), at published rates and equal work in physics. sip (†) is given "
            f"{sine['optimizer'].partition(', given ')[2]}.")


def write_findings(quick, contest):
    """Replaces the findings in README.md with those from the report.json in these two folders."""
    readme = ROOT / "README.md"
    before, rest = readme.read_text().split("<!-- findings -->\n")
    after = rest[rest.index("<!-- end of findings -->"):]
    lead, items = contest_findings(json.loads((contest / "report.json").read_text()))
    items.append(findings(json.loads((quick / "report.json").read_text())))
    text = textwrap.fill(lead, 118, break_on_hyphens=False) + "\n\n" + "".join(
        textwrap.fill(each, 118, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False) + "\n" for each in items)
    readme.write_text(before + "<!-- findings -->\n" + text + after)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    quick, contest = map(pathlib.Path, sys.argv[1:])
    picture(quick)
    write_findings(quick / "report", contest / "report")
