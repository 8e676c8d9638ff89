"""Converts a published curve to a record in a result folder.

    python3 clients/python/import_curve.py theirs.csv --out results/ours

theirs.csv has one point per row. theirs.json beside it describes the curve and its columns (schema
isoline.import/1, docs/exchanging-results.md). The record is marked as imported, and its values are not
verified. The targets for a curve on a problem of Isoline come from a record of the same problem and
seed in the same folder.
"""

import argparse
import csv
import datetime
import hashlib
import json
import math
import os
import pathlib
import re
import sys

RUNGS = [10 ** (-j / 5) for j in range(51)]
PLAIN_PRICES = {"forward": 1, "pullback": 1, "pushforward": 1, "hessian_product": 2}
ORACLES = ("forward", "pullback", "pushforward", "jacobian", "sparse_jacobian", "hessian", "curvature",
           "sensitivity", "hessian_product", "inverse", "network", "layer_factors", "layer_moments", "truth")
STATUSES = ("converged", "target", "budget", "stalled", "diverged")
TIMES = ("wall_seconds", "processor_seconds")
COLUMNS = ("loss", "iteration", "work", "x_error", "gradient_norm", "step_norm", *TIMES, *ORACLES[:-1])
NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?|inf(inity)?|nan)", re.I)
MOST_COUNT = 2 ** 53  # above it doubles skip whole numbers


class Refused(Exception):
    """An error in a file, in one sentence."""


def number(text):
    """As core/numbers.h reads it: with a sign, a decimal point, and an exponent by e or Fortran's d."""
    if not NUMBER.fullmatch(text):
        return None
    return float(re.sub(r"(?<=[\d.])[dD]", "e", text))


def separator_of(line):
    """Semicolons if the line has one, else commas, else blanks."""
    return next((each for each in ";,\t" if each in line), " " if " " in line.strip() else ",")


def fnv1a(text):
    state = 0xCBF29CE484222325
    for byte in text.encode():
        state = (state ^ byte) * 0x100000001B3 % 2 ** 64
    return f"{state:016x}"


def plain(value):
    """Isoline's JSON: infinities and NaN as texts."""
    if isinstance(value, float) and not math.isfinite(value):
        return "nan" if math.isnan(value) else "inf" if value > 0 else "-inf"
    if isinstance(value, dict):
        return {name: plain(member) for name, member in value.items()}
    return [plain(each) for each in value] if isinstance(value, list) else value


def json_text(value):
    return json.dumps(plain(value), sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def cell_digest(request):
    """The digest that names a cell, as in core/records/request.cpp."""
    def given(component):
        return {name: value for name, value in component["options"].items() if value != ""}
    problem, optimizer = request["problem"], request["optimizer"]
    return fnv1a(json_text({
        "budget": request["budget"], "optimizer": optimizer["name"],
        "optimizer_options": given(optimizer), "problem": problem["name"],
        "problem_options": given(problem), "seed": request["seed"], "threads": request["threads"]}))


def component(spec):
    """The component of a specification such as "name[a=1,b=text]"."""
    form = re.fullmatch(r"([A-Za-z][\w-]*)(?:\[(.*)\])?", spec)
    if not form:
        raise Refused(f"'{spec}' is not a specification such as name[option=1]")
    pairs = [pair.split("=", 1) for pair in (form[2] or "").split(",") if pair]
    if any(len(pair) != 2 for pair in pairs):
        raise Refused(f"'{spec}': every option must be name=value")
    return {"name": form[1], "options": dict(pairs), "spec": spec, "asked": spec}


def described(path):
    """The description, validated."""
    def require(is_good, why):
        if not is_good:
            raise Refused(f"{path}: {why}")
    try:
        told = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise Refused(f"{path}: {error.strerror}") from None
    except (ValueError, RecursionError):
        raise Refused(f"{path} is not JSON in UTF-8") from None
    require(isinstance(told, dict) and told.get("schema") == "isoline.import/1",
            "schema must be isoline.import/1")
    texts = ("schema", "problem", "optimizer", "source", "date", "program", "processor", "status",
             "claimed")
    numbers = ("minimum", "scale", "x_scale")
    counts = ("seed", "unknowns", "residuals")
    for name, value in told.items():
        kind = (str if name in texts else (int, float) if name in numbers else int if name in counts
                else dict if name == "columns" else None)
        require(kind, f"unknown member {name}")
        require(isinstance(value, kind) and not isinstance(value, bool), f"{name} has the wrong type")
        require(kind is not str or "\0" not in value, f"{name} has a zero byte")
    for name in ("problem", "optimizer", "source", "date", "columns"):
        require(told.get(name), f"{name} is missing")
    for name in ("problem", "optimizer"):
        try:
            component(told[name])
        except Refused as error:
            require(False, f"{name}: {error}")
    require(told.get("seed", -1) >= 0, "seed must be an integer of at least 0")
    require(told.setdefault("status", "budget") in STATUSES, f"status must be one of {STATUSES}")
    date = told["date"] if "T" in told["date"] else told["date"] + "T00:00:00Z"
    try:
        datetime.datetime.strptime(date, "%Y-%m-%dT%H:%M:%SZ")
    except ValueError:
        require(False, "date must be a day, as 2026-01-31, or an instant, as 2026-01-31T12:00:00Z, "
                       f"got '{told['date']}'")
    told["date"] = date
    require("scale" not in told or told.get("minimum") is not None,
            "scale needs minimum: it is a scale of the loss above the minimum")
    require(told.get("scale", 1) > 0, f"scale must be above 0, got {told.get('scale')}")
    columns = told["columns"]
    for name, column in columns.items():
        require(name in COLUMNS, f"columns: unknown quantity {name}")
        require(isinstance(column, str) and column or
                isinstance(column, int) and not isinstance(column, bool) and column > 0,
                f"columns: {name} must be a column name or a position from 1, got {column!r}")
    require("loss" in columns, "columns must contain loss")
    calls = [name for name in columns if name in ORACLES]
    dear = [name for name in calls if name not in PLAIN_PRICES]
    require("work" in columns or not dear, f"columns must contain work, too: the cost of {''.join(dear[:1])} "
            "depends on the problem")
    require("work" in columns or calls,
            "columns must contain the cost: work, or counts of calls such as forward")
    return told


def curve_of(path, told):
    """The columns by quantity; without a column of iterations, rows are counted from 0."""
    def refuse(line, why):
        raise Refused(f"{path}: line {line}: {why}")

    curve, places, width, previous = {}, {}, None, {}
    with open(path, encoding="utf-8-sig", newline="") as file:
        try:
            separator = separator_of(file.readline())
            file.seek(0)
            rows = csv.reader(file, skipinitialspace=True, delimiter=separator)
            for row in rows:
                row, line = [field.strip() for field in row], rows.line_num
                if not row:
                    continue
                if width is None:
                    width = len(row)
                    has_header = all(number(field) is None for field in row)
                    for quantity, column in told["columns"].items():
                        if isinstance(column, int):
                            if column > width:
                                refuse(line, f"{quantity} must be in column {column}, but the file has "
                                             f"{width}")
                            places[quantity] = column - 1
                        elif not has_header:
                            refuse(line, f"the file has no header with '{column}'; give the position of "
                                         f"the column of {quantity}")
                        elif row.count(column) != 1:
                            refuse(line, f"two columns are named '{column}'" if column in row else
                                   f"no column is named '{column}'; the columns are {', '.join(row)[:120]}")
                        else:
                            places[quantity] = row.index(column)
                    curve = {quantity: [] for quantity in places}
                    if has_header:
                        continue
                if len(row) != width:
                    refuse(line, f"expected {width} fields, as in the first line, got {len(row)}")
                for quantity, place in places.items():
                    field = row[place]
                    value = number(field)
                    is_count = quantity in ("iteration", "work") or quantity in ORACLES
                    if is_count:
                        if value is None or not 0 <= value <= MOST_COUNT or value != int(value):
                            refuse(line, f"{quantity} must be an integer of at least 0, got "
                                         f"'{field[:40]}'")
                        value = int(value)
                    elif value is None:
                        refuse(line, f"{quantity} is missing" if not field else
                               f"{quantity} is not a number, such as -1.5e-3: '{field[:40]}'")
                    elif quantity in TIMES and not value >= 0:
                        refuse(line, f"{quantity} must be at least 0, got {value}")
                    if is_count or quantity in TIMES:
                        last = previous.get(quantity, value)
                        if value < last:
                            refuse(line, f"{quantity} must not decrease, but falls from {last} to {value}")
                        if quantity == "iteration" and curve[quantity] and value == last:
                            refuse(line, f"iteration {value} occurs twice")
                        previous[quantity] = value
                    curve[quantity].append(value)
        except UnicodeDecodeError:
            raise Refused(f"{path}: it is not text in UTF-8") from None
        except csv.Error:
            refuse(rows.line_num, "a field is longer than 128 KiB, or a quotation mark is missing")
    if width is None:
        raise Refused(f"{path}: the file is empty")
    points = len(curve["loss"])
    if points == 0:
        raise Refused(f"{path}: the file has no row of numbers")
    curve.setdefault("iteration", list(range(points)))
    calls = [name for name in curve if name in PLAIN_PRICES]
    curve.setdefault("work", [sum(PLAIN_PRICES[name] * curve[name][i] for name in calls)
                              for i in range(points)])
    if not any(name in ORACLES for name in curve):
        curve["forward"] = curve["work"]  # otherwise the curve would cost nothing
    for name in TIMES:
        curve.setdefault(name, [math.inf] * points)
    for name in ("x_error", "gradient_norm", "step_norm"):
        curve.setdefault(name, [math.nan] * points)
    return curve


def kept_points(iterations):
    """The iterations that the meter keeps: 0 to 100, then 32 per decade, and the last."""
    kept, following = [], 0
    for i, iteration in enumerate(iterations):
        if iteration < following and i + 1 < len(iterations):
            continue
        kept.append(i)
        following, step = iteration + 1, 0
        if iteration >= 100:
            step = math.floor(32 * math.log10(iteration) + 1e-9)
            following = iteration
            while following <= iteration:
                following = math.floor(10 ** (step / 32) + 0.5)
                step += 1
    return kept


def hits_of(curve, minimum, scale):
    """The first row at or below each target."""
    calls = [name for name in curve if name in ORACLES]
    rows, i = [], 0
    for rung in RUNGS:
        while i < len(curve["loss"]) and not curve["loss"][i] <= minimum + rung * scale:
            i += 1
        rows.append(i if i < len(curve["loss"]) else None)
    def at(column):
        return [-1 if i is None else column[i] for i in rows]
    return {"target": RUNGS, "iteration": at(curve["iteration"]), "work": at(curve["work"]),
            "forwards": at(curve.get("forward", [0] * len(curve["loss"]))),
            "counts": {name: at(curve[name]) for name in calls},
            "wall_seconds": [math.nan if i is None else curve["wall_seconds"][i] for i in rows]}


def template_for(told, folder):
    """A record of the same problem and seed in the folder, or None if the folder lacks the problem."""
    name = component(told["problem"])["name"]
    is_there = False
    for file in sorted((folder / "runs").glob("*.json")):
        try:
            record = json.loads(file.read_text(encoding="utf-8"))
            request = record["request"]
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            print(f"left out: {file} is not a record, see `isoline validate`", file=sys.stderr)
            continue
        if "imported" in record or record["status"] == "inapplicable":
            continue
        if request["optimizer"]["name"] == component(told["optimizer"])["name"]:
            raise Refused(f"{request['optimizer']['name']} is an optimizer of Isoline: choose another "
                          "name, so that no row mixes both")
        problem = request["problem"]
        is_there = is_there or problem["name"] == name
        if told["problem"] in (problem["spec"], problem.get("asked")) and told["seed"] == request["seed"]:
            if cell_digest(request) != record["cell"]:
                raise Refused(f"{file}: its cell is not the digest of its request")
            return record
    if is_there:
        raise Refused(f"{folder} holds no run of {told['problem']} with seed {told['seed']}: run one "
                      "first, since the curve is measured by its targets")
    return None


def require_attainable(told, curve, template, file):
    """A loss below the least attainable one, beyond its error and rounding, is of another loss."""
    minimum = template["minimum"] if template else told.get("minimum")
    if minimum is None or template and template["request"]["problem"]["options"].get("mode") == "learn":
        return  # the best loss known of a learned problem may be bettered
    start = curve["loss"][0]
    slack = 1e-9 * max(abs(minimum), abs(start - minimum) if math.isfinite(start) else 0)
    for row, loss in enumerate(curve["loss"]):
        if -math.inf < loss < minimum - slack:
            raise Refused(f"{file}: the loss {loss} of point {row + 1} (work {curve['work'][row]}) is below "
                          f"{minimum}, the least attainable loss of {told['problem']}; is it the same loss, "
                          "with the same factor?")


def record_of(told, curve, files, template):
    unknown = "unknown"
    if template and any(name in told for name in ("minimum", "scale", "x_scale")):
        raise Refused(f"{told['problem']} is a problem of Isoline, which knows its minimum and scales: "
                      "remove minimum, scale and x_scale")
    request = {"problem": template["request"]["problem"] if template else component(told["problem"]),
               "optimizer": component(told["optimizer"]), "seed": told["seed"], "threads": 1,
               "rates": "", "budget": {"iterations": curve["iteration"][-1], "work": None,
                                       "seconds": math.inf, "target": 1e-10}}
    loss = curve["loss"]
    if template:
        minimum, scale = template["minimum"], template["scale"]
        if scale is not None and math.isfinite(loss[0] - minimum):
            scale = max(min(scale, loss[0] - minimum), 0.0)
    else:
        minimum, scale = told.get("minimum"), None
        if minimum is not None and math.isfinite(loss[0] - minimum):
            scale = max(min(told.get("scale", math.inf), loss[0] - minimum), 0.0)
    kept = kept_points(curve["iteration"])
    thinned = {name: [column[i] for i in kept] for name, column in curve.items()}
    calls = {name: thinned.pop(name) for name in list(thinned) if name in ORACLES}
    finite = [value for value in loss if not math.isnan(value)]
    build = fnv1a(files["description"] + files["curve"])
    unverified = {"1e-1": None, "1e-3": None, "1e-6": None}
    record = {
        "schema": "isoline.run/1", "cell": cell_digest(request), "build": build,
        "build_parts": {"imported": build}, "request": request,
        "status": told["status"] if math.isfinite(loss[-1]) else "diverged", "message": "",
        "claimed": told.get("claimed", ""), "aim": template["aim"] if template else "loss",
        "minimum": minimum, "scale": scale,
        "x_scale": template["x_scale"] if template else told.get("x_scale"),
        "x_floor": template["x_floor"] if template else 0.0,
        "verified": unverified, "found": unverified,
        "counts": {name: calls[name][-1] if name in calls else 0 for name in ORACLES},
        "prices": template["prices"] if template else {
            name: PLAIN_PRICES.get(name, 0) for name in ORACLES},
        "summary": {"iterations": curve["iteration"][-1], "work": curve["work"][-1],
                    "rejected_steps": 0, "start_loss": loss[0], "loss": loss[-1],
                    "best_loss": min(finite, default=math.nan),
                    "start_x_error": curve["x_error"][0], "x_error": curve["x_error"][-1],
                    "gradient_norm": curve["gradient_norm"][-1],
                    "wall_seconds": curve["wall_seconds"][-1],
                    "processor_seconds": curve["processor_seconds"][-1], "peak_memory_bytes": 0},
        "curve": {**thinned, "counts": calls}, "privileges": [], "nondeterministic": False,
        "repeat_wall_seconds": [curve["wall_seconds"][-1]],
        "provenance": {"version": unknown, "commit": unknown, "dirty": False, "compiler": unknown,
                       "flags": unknown, "instruction_set": unknown,
                       "processor": told.get("processor") or unknown,
                       "libraries": {"program": told.get("program") or unknown},
                       "run": {"started": told["date"], "concurrent_jobs": 1, "exclusive": False,
                               "command": ""}},
        "imported": {"source": told["source"], "program": told.get("program", ""),
                     "curve": files["name"], "sha256": hashlib.sha256(files["bytes"]).hexdigest()}}
    if minimum is not None and scale is not None:
        record["hits"] = hits_of(curve, minimum, scale)
    return record


def sheet(kind, given, title, told, **members):
    return {"schema": "isoline.component/1", "kind": kind, "name": given["name"],
            "spec": given["spec"], "title": title, "formula": "", "source": told["source"],
            "note": "", "options": [], "privileges": [], "oracles": [], "inverse": "",
            "family": "", "tunable": "", "unknowns": 0, "residuals": 0, "target": [], "truth": [],
            **members}


def write(path, value):
    """Writes the complete file or nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_suffix(f".{os.getpid()}.tmp")
    fresh.write_text(json_text(value) + "\n", encoding="utf-8")
    os.replace(fresh, path)


def import_curve(curve_file, description_file, folder):
    told = described(description_file)
    read = curve_file.read_bytes()
    if b"\0" in read:
        line = read[:read.index(b"\0")].count(b"\n") + 1
        raise Refused(f"{curve_file}: line {line}: a zero byte is not allowed")
    curve = curve_of(curve_file, told)
    template = template_for(told, folder)
    require_attainable(told, curve, template, curve_file)
    files = {"description": description_file.read_text(encoding="utf-8"), "bytes": read,
             "curve": read.decode(errors="replace"), "name": curve_file.name}
    record = record_of(told, curve, files, template)
    optimizer, problem = record["request"]["optimizer"], record["request"]["problem"]
    out = folder / "runs" / f"{record['cell']}-{record['build']}.json"
    write(out, record)
    sheets = [sheet("optimizer", optimizer, "imported method; its values are not verified", told,
                    family="imported", note=f"Imported from {curve_file.name}; Isoline neither ran nor "
                                            "verified it.")]
    if not template:
        sheets.append(sheet("problem", problem, "imported problem", told, inverse="none",
                            unknowns=told.get("unknowns", 0), residuals=told.get("residuals", 0)))
        print(f"{problem['name']} has no run in {folder}; it gets a table of its own")
    for each in sheets:
        file = folder / "components" / f"{each['kind']}-{each['name']}-{fnv1a(each['spec'])}.json"
        if not file.exists():
            write(file, each)
    print(f"{out}: {problem['spec']} × {optimizer['spec']}, seed {told['seed']}, "
          f"{len(curve['loss'])} points, {len(record['curve']['loss'])} kept; imported, not verified")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("curve", type=pathlib.Path, help="CSV file, one point per row")
    parser.add_argument("--description", type=pathlib.Path, help="default: CURVE with .json")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="the result folder")
    given = parser.parse_args()
    try:
        import_curve(given.curve, given.description or given.curve.with_suffix(".json"), given.out)
    except (Refused, OSError) as error:
        sys.exit(f"import_curve: {error}")


if __name__ == "__main__":
    main()
