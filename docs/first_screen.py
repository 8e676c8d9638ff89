#!/usr/bin/env python3
"""Writes what the first screen of README.md shows: six findings and a moving picture.

    ./isoline run quick && python3 docs/first_screen.py results/quick

The findings come from report.json and replace the text between the two markers in README.md. The
picture, docs/heat.svg, shows x of `heat` at the snapshots of three records, against forward solves.
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
    """Images of one panel, and for each the frames at which it is seen; all frames where empty."""
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
    truth, target = (next(iter(found.values()))[1][1], next(iter(found.values()))[1][0])
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
        images = [png(x, low, high) for x in arrays[2:]]
        parts += panel(column, title, images,
                       [{f for f in range(FRAMES) if latest[f] == i} for i in range(len(images))])
        for i, x in enumerate(arrays[2:]):
            error = math.sqrt(sum((a - b) ** 2 for r, s in zip(x, truth) for a, b in zip(r, s))) / norm
            shown = {f for f in range(FRAMES) if latest[f] == i}
            place = 10 + column * (SIDE + 14) + SIDE / 2
            parts.append(f'<text x="{place}" y="{SIDE + 48}" text-anchor="middle" opacity="0">'
                         f'error {100 * error:.0f} %{animation(shown)}</text>')
    for frame, work in enumerate(works):
        parts.append(f'<text x="10" y="{SIDE + 48}" opacity="0">{min(work, most)} forward solves'
                     f'{animation({frame})}</text>')
    width, height = 6 + 5 * (SIDE + 14), SIDE + 60
    (ROOT / "docs/heat.svg").write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        f'viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="13">\n'
        f'<rect width="{width}" height="{height}" fill="#fff"/>\n' + "\n".join(parts) + "\n</svg>\n")


def findings(results):
    """Six sentences with numbers of report.json."""
    report = json.loads((results / "report.json").read_text())
    by_name = {each["optimizer"]: each["standings"]["1e-6"] for each in report["optimizers"]}
    leader = report["leader"]
    first, second = leader["places"][:2]
    settings = leader["settings"]
    by_time = next(c["first"] for c in leader["choices"] if c["choice"] == "by wall time")

    def solves(name):
        return f"{name} solves {by_name[name]['solved']}"

    exact = [c for c in report["cells"]
             if c["optimizer"] == "sip, given P⁻¹" and "exact inverse of the physics" in c["privileges"]
             and "mode=learn" not in c["problem"]]
    least = [c for c in exact if float(c["costs"]["1e-6"]["median"]) <= 3]
    error = {c["optimizer"]: c["figures"]["x_error"] for c in report["cells"]
             if c["problem"].startswith("sine[") and "mode=learn" in c["problem"]}
    sip = next(value for name, value in error.items() if name.startswith("sip"))
    best = "One method is" if leader["significant"] else "No method is"
    band = sum(place["in_group"] for place in leader["places"])
    return [
        f"{best} significantly best by evaluation work. {first['optimizer']} ranks first (solves "
        f"{first['solved']} of {settings} problems), {second['optimizer']} second (solves "
        f"{second['solved']}; paired permutation test, p = {second['p']:.2f}); {band} of "
        f"{len(leader['places'])} are not significantly worse than the best.",
        f"By wall time {' and '.join(by_time)} ranks first.",
        f"{solves('adam')} with a tuned rate; its median work is {by_name['adam']['typical']:.0f} "
        f"times the least. {solves('gd')}.",
        f"{solves('hig')}, with a median of {by_name['hig']['typical']:.0f} times the least work.",
        f"sip † with an exact inverse of the simulation solves {len(least)} of {len(exact)} problems "
        "with three forward solves each.",
        f"A network trained by sip † to invert a sine map ends with {error['adam']['median'] / sip['median']:.0f} "
        f"times smaller error in x than one trained by adam in as many steps ({sip['n']} seeds).",
    ]


def write_findings(results):
    readme = ROOT / "README.md"
    before, rest = readme.read_text().split("<!-- findings -->\n")
    after = rest[rest.index("<!-- end of findings -->"):]
    items = "".join(textwrap.fill(each, 118, initial_indent="- ", subsequent_indent="  ",
                                  break_on_hyphens=False) + "\n"
                    for each in findings(results))
    readme.write_text(before + "<!-- findings -->\n" + items + after)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    picture(pathlib.Path(sys.argv[1]))
    write_findings(pathlib.Path(sys.argv[1]))
