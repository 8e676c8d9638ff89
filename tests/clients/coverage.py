"""How often 95 % intervals contain the true x: of many data sets, fitted and profiled by the program.

    coverage.py ISOLINE COVERAGE.so [--data 2000] [--only TEXT]... [--folder DIR]

COVERAGE.so is tests/plugin/coverage.c; its seeds are data sets with other noise. Prints a line per problem, unknown and
kind of interval: the share that covers, with its Wilson interval (95 %), and the data sets that have one. Where an unknown
has a bound, `held` are the data sets whose fit it holds. Exits with 1 if a share is outside 93 to 97 % by more than chance,
or if printed digits move an end of a profile by more than 2 % of its interval.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile

TRUTH = {"covered-decay": [5, 0.9, 1], "covered-kinetics": [210, 65, 1]}
SIGMA = {"covered-decay": 0.15, "covered-kinetics": 10}
VARIANTS = ["", ",printed=6", ",bounded=1", ",bounded=1,printed=6"]
OPTIMIZERS = "levenberg-marquardt,levenberg-marquardt[jacobian=central]"  # as isoline.fit tries them
BATCH = 250  # data sets of one folder
LEAST, MOST = 0.93, 0.97
MOVED = 0.02  # of an interval


def wilson(covered, count, z=1.96):
    share, square = covered / count, z * z / count
    half = z * math.sqrt(share * (1 - share) / count + square / (4 * count)) / (1 + square)
    middle = (share + square / 2) / (1 + square)
    return middle - half, middle + half


def solutions(given, problem, first, count, folder):
    """What `isoline solution --profile` says of these data sets."""
    out = os.path.join(folder, f"{problem.replace('=', '-').replace(',', '_').strip(']')}-{first}".replace("[", "_"))
    plugin, quiet = ["--plugin", given.plugin], {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE}
    steps = (["run", "--problem", problem, "--seeds", f"{first}..{first + count - 1}", "--optimizer", OPTIMIZERS, "--out", out,
              "--uncertified", "--no-report", "--quiet", "--jobs", str(given.jobs)],
             ["solution", out, "--profile", "--trust", "--format", "json", "--out", out + ".json"])
    for words in steps if not os.path.exists(out + ".json") else ():
        ran = subprocess.run([given.isoline, *words, *plugin], **quiet)
        if ran.returncode not in (0, 2):
            sys.exit(f"{' '.join(words)}: {ran.stderr.decode()[-2000:]}")
    with open(out + ".json", encoding="utf-8") as file:
        return json.load(file)


def counted(all_sets, truth):
    """(group, unknown, kind) -> [covered, data sets]; and the data sets without intervals."""
    counts, without = {}, 0
    for each in all_sets:
        if "interval" not in each:
            without += 1
            continue
        names, held = each["unknowns"], any(each.get("active_bounds", []))
        ends = [("t", name, *map(float, ends)) for name, ends in zip(names, each["interval"])]
        ends += [("profile", one["unknown"], float(one["low"]), float(one["high"])) for one in each.get("profile", [])]
        for kind, name, low, high in ends:
            if kind == "t" and low != low:  # a bound holds it
                continue
            for group in ("all", "held" if held else "free"):
                entry = counts.setdefault((group, name, kind), [0, 0])
                entry[0] += low <= truth[names.index(name)] <= high
                entry[1] += 1
    return counts, without


def moved_ends(exact, printed):
    """By how much printed digits move ends of profiles, in parts of the intervals, with seed and unknown, the most first.

    Not where they decide whether a bound holds an unknown, since the degrees of freedom then differ.
    """
    key = lambda fit, one: (fit["seed"], fit["degrees_of_freedom"], one["unknown"])
    ends, found = {key(each, one): one for each in exact for one in each.get("profile", [])}, []
    for each in printed:
        for one in each.get("profile", []):
            other = ends.get(key(each, one), {"low": "nan", "high": "nan"})
            (low, high), (left, right) = [map(float, (of["low"], of["high"])) for of in (other, one)]
            if math.isfinite(high - low):
                found.append((max(abs(left - low), abs(right - high)) / (high - low), each["seed"], one["unknown"]))
    return sorted(found, reverse=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("isoline")
    parser.add_argument("plugin")
    parser.add_argument("--data", type=int, default=2000)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--folder")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        sys.exit(simulate(given, given.folder or temporary))


def simulate(given, folder):
    is_wrong = False
    os.makedirs(folder, exist_ok=True)
    for name, truth in TRUTH.items():
        exact = {}
        for variant in VARIANTS:
            problem = f"{name}[sigma={SIGMA[name]}{variant}]"
            if given.only and problem not in given.only:
                continue
            found = [each for first in range(0, given.data, BATCH)
                     for each in solutions(given, problem, first, min(BATCH, given.data - first), folder)]
            exact.setdefault(variant.replace(",printed=6", ""), found)
            true = truth[:2] + [0.0 if "bounded" in variant else truth[2]]
            counts, without = counted(found, true)
            unknown = sum("profile" not in each for each in found) - without
            print(f"{problem}: {len(found)} data sets, {without} without intervals, {unknown} more without profiles", flush=True)
            for (group, unknown, kind), (covered, count) in sorted(counts.items()):
                low, high = wilson(covered, count)
                is_its_own = unknown == "x3" and "bounded" in variant  # which is true at its bound
                is_off = high < LEAST or low > MOST
                is_wrong |= is_off and not is_its_own and group != "free"
                print(f"  {group:4} {unknown:3} {kind:8} {covered / count:7.2%}  ({low:.2%} to {high:.2%}) of {count}"
                      f"{'  outside' if is_off else '' if LEAST <= covered / count <= MOST else '  just outside'}", flush=True)
            moved = moved_ends(exact[variant.replace(",printed=6", "")], found) if "printed" in variant else []
            if moved and moved[0][0] > 0:
                far = sum(each[0] > MOVED for each in moved)
                is_wrong |= far > 0
                print("  digits move {} of {} profiles by more than {:.0%}; most: {:.2%}, seed {}, {}".format(
                    far, len(moved), MOVED, *moved[0]), flush=True)
    return is_wrong


if __name__ == "__main__":
    main()
