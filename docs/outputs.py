#!/usr/bin/env python3
"""Checks the blocks of output in README.md and docs/ against what their commands print, or rewrites them.

    python3 docs/outputs.py build/portable/isoline            # lists the lines that are not printed
    python3 docs/outputs.py build/portable/isoline --write    # and replaces them
    python3 docs/outputs.py FILE --printed --shape PAGE       # FILE has what the commands of one page printed

A block of output is a fence ```text. It shows lines that the ```sh blocks before it print, or the command
after the word `text`, or their first columns, or after "… " their ends. Times, paths and digests are masked; with
--shape, all numbers are.
"""

import argparse
import difflib
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
WHOLE = ("./isoline run", "./isoline test")  # these need the whole machine
MASKS = [(r"[\d.e+-]+(?=≈| (?:ms|s|min|h)\b)", "TIME"), (r"(?:[\w.-]*/)+[\w.-]+", "PATH"), (r"\b[0-9a-f]{8,64}\b", "DIGEST")]


def masked(line, shape):
    for pattern, name in MASKS + ([(r"[\d.,]*\d(?:e[+-]?\d+)?", "#")] if shape else []):
        line = re.sub(pattern, name, line)
    return " ".join(line.split())


def shows(line, whole):
    return whole.endswith(line[2:]) if line.startswith("… ") else whole.startswith(line)


def blocks(lines):
    """The first line, the end and the info string of each fence."""
    begin = -1
    for i, line in enumerate(lines):
        if not line.startswith("```"):
            continue
        if begin < 0:
            begin = i
        else:
            yield begin + 1, i, lines[begin][3:]
            begin = -1


def scripts(lines):
    for begin, end, info in blocks(lines):
        if info == "python" and lines[begin].startswith("# "):
            yield lines[begin][2:], "\n".join(lines[begin:end]) + "\n"


def printed(command, folder):
    there = os.environ | {"PYTHONPATH": str(ROOT / "clients/python")}
    return subprocess.run(command, shell=True, cwd=folder, env=there, text=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False).stdout.split("\n")


def fresh(block, out, shape):
    """The lines of `out` that a block shows; None for a line that is not printed."""
    known = {}
    for i, line in enumerate(out):
        known.setdefault(masked(line, shape), []).append(i)
    if all(masked(line, shape) in known for line in block):
        return [out[known[masked(line, shape)][0]] for line in block]
    words = [re.sub(r"[\d.e*✗≈ -]+", " ", line) for line in out]

    def likeness(line, at):
        return difflib.SequenceMatcher(None, re.sub(r"[\d.e*✗≈ -]+", " ", line), words[at]).ratio()

    begins = max(range(len(out)), key=lambda i: sum(likeness(line, i + k) for k, line in enumerate(block[:4]) if i + k < len(out)))
    found, at = [], begins
    for line in block:
        near = range(at, min(at + 30, len(out)))
        best = max(near, key=lambda i: likeness(line, i) - (i - at) / 1000, default=-1)
        if best < 0 or likeness(line, best) < 0.5:
            found.append(None)
        else:
            found.append(out[best])
            at = best + 1
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("pages", nargs="*")
    for option in ("--write", "--printed", "--shape"):
        parser.add_argument(option, action="store_true")
    asked = parser.parse_intermixed_args()
    pages = asked.pages or ["README.md", *sorted(f"docs/{page.name}" for page in ROOT.glob("docs/*.md"))]
    differ = 0
    for page in pages:
        path = ROOT / page
        lines = path.read_text().split("\n")
        if not any(info.startswith("text") for _, _, info in blocks(lines)):
            continue
        with tempfile.TemporaryDirectory() as folder:
            if not asked.printed:
                pathlib.Path(folder, "isoline").symlink_to(asked.program.resolve())
                pathlib.Path(folder, "clients").symlink_to(ROOT / "clients")
                for name, text in scripts(lines):
                    pathlib.Path(folder, name).write_text(text)
            out = asked.program.read_text().split("\n") if asked.printed else []
            for begin, end, info in list(blocks(lines)):
                if info == "sh" and not asked.printed:
                    for command in lines[begin:end]:
                        if command and command not in WHOLE:
                            out += printed(command, folder)
                if not info.startswith("text") or (asked.printed and info != "text"):
                    continue
                here = printed(info[5:], folder) if info != "text" else out
                block = [line for line in lines[begin:end] if line.strip() not in ("", "…")]
                known = [masked(line, asked.shape) for line in here]
                missing = [line for line in block if not any(shows(masked(line, asked.shape), one) for one in known)]
                if not missing:
                    continue
                differ += len(missing)
                for line in missing:
                    print(f"{page}:{begin + 1}: not printed: {line}")
                if asked.write:
                    new = iter(fresh(block, here, asked.shape))
                    for i in range(begin, end):
                        if lines[i].strip() not in ("", "…"):
                            lines[i] = next(new) or lines[i]
        if asked.write:
            path.write_text("\n".join(lines))
    return 1 if differ and not asked.write else 0


if __name__ == "__main__":
    sys.exit(main())
