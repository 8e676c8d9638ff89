"""Writes results in the formats of other programs: curves or runs as CSV, or data folders of COCO.

    isoline export results/quick --out curves.csv
    isoline export results/quick --format runs --out runs.csv
    isoline export results/quick --format coco --out exdata

COCO's format (Hansen et al. 2021, Optim. Methods Softw. 36:114-144) is that of its single-objective
suite: an index, .info, and two tables per function and dimension, .dat by targets and .tdat by
evaluations, with a block per run in both. Problems are its functions, numbered as functions.csv says;
instance s is its instance s + 1; an evaluation is one forward solve of declared work, counted from 1,
the start. Its values are f − f_L.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import sys

import isoline

START = 1  # the start's own evaluation, which the harness pays for


def chosen_runs(cells):
    """The runs that a comparison counts: {(cell, build): (cell of the comparison, f_L, s, works)}."""
    return {(run[0], run[1]): (cell, float(run[2]), float(run[3]), run[5])
            for cell in cells for run in cell["records"] if not run[4]}


# --- CSV: a row per kept point; a run that kept none has one row without figures


def write_csv(results, chosen, out):
    given = ["problem", "optimizer", "seed", "status", "cell", "build", "imported", "verified_1e-1",
             "verified_1e-3", "verified_1e-6", "minimum", "scale", "x_scale"]
    oracles = [name.removesuffix("_calls") for name in results.runs.columns if name.endswith("_calls")]
    figures = ["iteration", "work", *oracles, "wall_seconds", "processor_seconds", "loss", "x_error",
               "gradient_norm", "step_norm"]
    curves = results.curves.reindex(columns=[*isoline.KEYS, *figures], fill_value=0)
    points = dict(list(curves.groupby(isoline.KEYS, sort=False)))
    with open(out, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow([*given, *figures])
        runs = results.runs.sort_values(["problem", "optimizer", "seed", "cell"])
        for row in zip(*(runs[name].tolist() for name in given)):
            key, run = (row[4], row[5]), ["" if value != value else in_csv(value) for value in row]
            if key not in chosen:
                continue
            if key not in points:
                rows.writerow([*run, *("" for _ in figures)])
                continue
            for point in zip(*(points[key][name].tolist() for name in figures)):
                rows.writerow([*run, *map(in_csv, point)])


def in_csv(value):
    """The shortest text that reads back as the same value; what is not known is empty."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value).removesuffix(".0") if isinstance(value, float) else str(value)


def write_runs(results, chosen, out):
    """A row per run, with the work at which it first met each tolerance of its success criterion."""
    asked = ["problem", "optimizer", "seed", "status"]
    figures = ["minimum", "scale", "x_scale", "iterations", "work", "start_loss", "loss", "best_loss", "start_x_error",
               "x_error"]
    tolerances = list(next(iter(chosen.values()))[3]) if chosen else []
    runs = results.runs.reindex(columns=[*asked, *figures, *isoline.KEYS])
    with open(out, "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow([*asked, *(f"work_to_{tau}" for tau in tolerances), *figures, *isoline.KEYS])
        for row in runs.sort_values([*asked[:3], "cell"]).itertuples(index=False):
            key = tuple(row[-len(isoline.KEYS):])
            if key in chosen:
                values = ["" if value != value else in_csv(value) for value in row]
                works = [in_csv(float(work)) for work in chosen[key][3].values()]
                rows.writerow([*values[:len(asked)], *works, *values[len(asked):]])


# --- COCO


def curve_points(curve, minimum):
    """[evaluations, loss, best loss] where losses are finite, the last of those at one evaluation."""
    points, best = [], math.inf
    for work, loss in zip(curve["work"].tolist(), (curve["loss"] - minimum).tolist()):
        if not math.isfinite(loss):
            continue
        best = min(best, loss)
        if points and points[-1][0] == work + START:
            points.pop()
        points.append((work + START, loss, best))
    return points


def target_points(points, hits, scale):
    """The first points at each best loss: exact where the record has hits, which are finer than the
    curve. A hit gives the target only, τ s: the loss was at most that."""
    met = {}
    for evaluations, _, best in points:
        met[evaluations] = min(best, met.get(evaluations, math.inf))
    if hits is not None and scale > 0:
        for iteration, work, target in zip(*(hits[name].tolist() for name in ("iteration", "work", "target"))):
            if iteration >= 0:
                met[work + START] = min(target * scale, met.get(work + START, math.inf))
    falling = []
    for evaluations in sorted(met):
        if not falling or met[evaluations] < falling[-1][2]:
            falling.append((evaluations, met[evaluations], met[evaluations]))
    return falling


def instance_of(seed):
    """Of a pair of an instance and a start, which one seed encodes, the instance; as core/seeds.h."""
    first_pair, limit = 1_000_000, 1_000
    return (seed - first_pair) // limit if first_pair <= seed < first_pair + limit**2 else seed


def block(points, minimum):
    head = (f"% function evaluation | noise-free fitness - Fopt ({minimum:.16e}) | best noise-free fitness - Fopt | "
            "measured fitness | best measured fitness\n")
    return head + "".join(
        f"{evaluations} {loss:+.16e} {best:+.16e} {loss + minimum:+.16e} {best + minimum:+.16e}\n"
        for evaluations, loss, best in points)


def folders_of(methods):
    """Each method's folder: letters, digits and dashes, which any file system has, none twice."""
    taken, folders = set(), {}
    for method in methods:
        name = re.sub("[^A-Za-z0-9]+", "-", method)[:81].lstrip("-")[:80].rstrip("-") or "method"
        folder, number = name, 2
        while folder in taken:
            folder, number = f"{name}-{number}", number + 1
        taken.add(folder)
        folders[method] = folder
    return folders


def write_coco(results, report, out):
    curves = dict(list(results.curves.groupby(isoline.KEYS, sort=False)))
    hits = dict(list(results.hits.groupby(isoline.KEYS, sort=False)))
    seeds = results.runs.set_index(isoline.KEYS)["seed"]
    folders = folders_of(dict.fromkeys(cell["optimizer"] for cell in report["cells"]))
    unknowns = {}
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "functions.csv", "w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(["funcId", "DIM", "problem"])
        for number, problem in enumerate(report["problems"], 1):
            if problem.get("unknowns", 0) <= 0:
                say(f"{problem['problem']}: no file of metadata gives its number of unknowns")
                continue
            unknowns[problem["problem"]] = (number, problem["unknowns"])
            rows.writerow([number, problem["unknowns"], problem["problem"]])
    for cell in report["cells"]:
        if cell["problem"] not in unknowns:
            continue
        number, dimension = unknowns[cell["problem"]]
        by_target, by_evaluation, instances = "", "", ""
        for key, (_, minimum, scale, _) in chosen_runs([cell]).items():
            if key not in seeds:
                continue
            points = curve_points(curves[key], minimum) if key in curves else []
            seed = int(seeds[key])
            if not points:
                say(f"{cell['problem']} × {cell['optimizer']}, seed {seed}: no finite loss above f_L")
                continue
            targets = target_points(points, hits.get(key), scale)
            by_target += block(targets, minimum)
            by_evaluation += block(points, minimum)
            last = max(targets[-1][0], points[-1][0])
            instances += f", {instance_of(seed) + 1}:{last}|{targets[-1][2]:.1e}"
        if not instances:
            continue
        table = f"data_f{number}/isoline_f{number}_DIM{dimension}"
        folder = out / folders[cell["optimizer"]]
        (folder / table).parent.mkdir(parents=True, exist_ok=True)
        method = cell["optimizer"].replace("'", '"')
        (folder / f"isoline_f{number}.info").write_text(
            f"funcId = {number}, DIM = {dimension}, Precision = 1.000e-08, algId = '{method}'\n"
            f"% {cell['problem']}; evaluations are forward solves, and the start is the first; instances are "
            f"counted from 1\n{table}.dat{instances}\n", encoding="utf-8")
        (folder / f"{table}.dat").write_text(by_target, encoding="utf-8")
        (folder / f"{table}.tdat").write_text(by_evaluation, encoding="utf-8")


def say(sentence):
    print(f"left out: {sentence}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("folders", nargs="+", help="result folders")
    parser.add_argument("--runs", required=True, help="JSON of the problems and cells of a comparison, as in report.json")
    parser.add_argument("--format", choices=["csv", "runs", "coco"], default="csv")
    parser.add_argument("--out", required=True, help="a file, or a folder for several")
    given = parser.parse_args()
    report = json.loads(pathlib.Path(given.runs).read_text(encoding="utf-8"))
    chosen = chosen_runs(report["cells"])
    results = isoline.load(*given.folders, only=set(chosen))
    for key in sorted(chosen.keys() - set(results.runs[isoline.KEYS].itertuples(index=False, name=None))):
        say(f"{'-'.join(key)}.json: a column of its curve or of its hits has values that are not numbers")
    if given.format == "csv":
        write_csv(results, chosen, given.out)
    elif given.format == "runs":
        write_runs(results, chosen, given.out)
    else:
        write_coco(results, report, pathlib.Path(given.out))


if __name__ == "__main__":
    main()
