"""Peers beside Isoline's defaults: the work of each to 1e-6, and its row of conduct.

    ./isoline run --problem … --optimizer '@peers,levenberg-marquardt,dfo-gn' --rates none --work 2000 --out FOLDER
    python3 docs/peers.py take FOLDER…       rows of their report/report.csv into benchmarks/published/peers.csv
    python3 docs/peers.py page PAGE.md       writes the section between the marks of the page
"""
import csv
import json
import pathlib
import re
import statistics
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
PUBLISHED = ROOT / "benchmarks/published/peers.csv"
CONDUCT = ROOT / "clients/peers/conduct/conduct.json"
COLUMNS = ("problem", "optimizer", "seed", "status", "work_to_1e-6", "cell", "build")
ENDS = ("converged", "unconfirmed", "stalled")  # by the method's own test
OURS = {"with derivatives": "levenberg-marquardt", "without derivatives": "dfo-gn"}
# Names of the rows of conduct; others are "SciPy METHOD".
ROWS = {"trf": "SciPy least_squares trf", "dogbox": "SciPy least_squares dogbox", "l-bfgs-b": "SciPy L-BFGS-B",
        "slsqp": "SciPy SLSQP", "nelder-mead": "SciPy Nelder-Mead", "powell": "SciPy Powell", "cobyla": "SciPy COBYLA",
        "lmfit_peer leastsq": "lmfit leastsq", "lmfit_peer least_squares": "lmfit least_squares",
        "iminuit_peer": "iminuit MIGRAD", "pounders": "TAO POUNDERS", "tao brgn": "TAO BRGN", "tao blmvm": "TAO BLMVM",
        "tao lmvm": "TAO LMVM", "r_packages nls.lm": "R nls.lm", "r_packages nloptr": "R nloptr",
        "r_packages bobyqa": "R bobyqa", "leasqr": "Octave leasqr", "dlib bobyqa": "dlib find_min_bobyqa",
        "dlib lbfgs": "dlib find_min_lbfgs", "dlib global": "dlib find_min_global", "alglib": "ALGLIB minlm",
        "alglib_gradient minlbfgs": "ALGLIB minlbfgs", "alglib_gradient minbleic": "ALGLIB minbleic",
        "lbfgs": "liblbfgs", "ipopt": "Ipopt", "pagmo cmaes": "pagmo cmaes", "pagmo de": "pagmo de"}


def peer_of(spec):
    """The name of the row of conduct, of a command that ends with a script and its method."""
    found = re.findall(r"(\w+)\.(?:py|R|m|cpp)\b ?([^\]\"/]*)", spec)
    if not found:
        return spec
    name = " ".join(found[-1]).strip().replace("scipy_optimize ", "")
    return ROWS.get(name, f"SciPy {name}")


def is_tuned(spec):
    """Whether it is one of our methods with other options than its defaults."""
    return any(spec.startswith(f"{name}[") or spec.startswith(f"{name},") for name in OURS.values())


def take(folders):
    rows = []
    for folder in folders:
        with open(pathlib.Path(folder) / "report" / "report.csv", newline="") as file:
            rows += [{column: row[column] for column in COLUMNS} for row in csv.DictReader(file)]
    rows = [row | {"optimizer": peer_of(row["optimizer"])} for row in rows if not is_tuned(row["optimizer"])]
    rows = {(row["problem"], row["optimizer"]): row for row in rows}.values()
    with open(PUBLISHED, "w", newline="") as file:
        out = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        out.writeheader()
        out.writerows(sorted(rows, key=lambda row: (row["problem"], row["optimizer"])))


def verdict(peer, works, ended, settings):
    """Where our default needs less work, where the peer does, and where a test of the peer decided that."""
    better, worse, ratios, early = [], [], [], 0
    for kind, ours in OURS.items():
        for setting in settings[kind]:
            mine, theirs = works.get((setting, ours)), works.get((setting, peer))
            if None in (mine, theirs):
                continue
            (better if mine < theirs else worse if theirs < mine else []).append(kind)
            early += mine < theirs and (setting, peer) in ended
            if max(mine, theirs) < float("inf"):
                ratios.append(theirs / mine)
    if not better and not worse:
        return "No setting decides."
    parts = []
    for kind, ours in OURS.items():
        if better.count(kind) + worse.count(kind):
            parts.append(f"{kind}, `{ours}` needs less work in {better.count(kind)} and more in {worse.count(kind)} settings")
    choice = "Our default is the better choice" if len(better) > len(worse) else \
        "The peer is the better choice" if len(worse) > len(better) else "Neither is the better choice"
    middle = f"; where both reach 1e-6, the peer takes {statistics.median(ratios):.3g} times the work" if ratios else ""
    end = f" In {early} of these settings a test of the peer, at its tolerances, ended the run before 1e-6." if early else ""
    return f"{choice} here: {'; '.join(parts)}{middle}.{end}"


def page(path):
    with open(PUBLISHED, newline="") as file:
        rows = list(csv.DictReader(file))
    number = lambda text: float("inf") if text in ("", "inf", "nan") else float(text)
    works = {(row["problem"], row["optimizer"]): number(row["work_to_1e-6"]) for row in rows
             if row["status"] != "inapplicable"}
    ended = {(row["problem"], row["optimizer"]) for row in rows if row["status"] in ENDS}
    settings = {kind: [] for kind in OURS}
    for row in rows:
        kind = "without derivatives" if "derivatives=none" in row["problem"] else "with derivatives"
        if row["problem"] not in settings[kind]:
            settings[kind].append(row["problem"])
    conduct = json.loads(CONDUCT.read_text())["methods"]
    peers = sorted({row["optimizer"] for row in rows} - set(OURS.values()))
    text = lambda setting, name: "–" if (setting, name) not in works else \
        f"{works[setting, name]:.0f}" if works[setting, name] < float("inf") else \
        "ended" if (setting, name) in ended else "✗"
    short = lambda setting: re.sub(r",?derivatives=none|\[derivatives=none\]", "", setting)
    lines = []
    for kind, ours in OURS.items():
        lines += ["", f"Work to 1e-6, {kind}, in forward solves:", "",
                  f"| method | {' | '.join(f'`{short(each)}`' for each in settings[kind])} |", "|---|" + "---:|" * len(settings[kind])]
        for name in [ours, *peers]:
            cells = [text(setting, name) for setting in settings[kind]]
            if set(cells) != {"–"}:
                lines.append(f"| {name} | {' | '.join(cells)} |")
    lines += ["", "| peer | its row of conduct: ✗ | are our defaults the better choice? |", "|---|---|---|"]
    for peer in peers:
        crosses = [column for column, cell in conduct.get(peer, {}).items() if cell["mark"] == "✗"]
        row = ", ".join(crosses) or ("none" if peer in conduct else "not measured")
        lines.append(f"| {peer} | {row} | {verdict(peer, works, ended, settings)} |")
    begin, end = "<!-- peers -->", "<!-- end of peers -->"
    whole = pathlib.Path(path).read_text()
    pathlib.Path(path).write_text(f"{whole.split(begin)[0]}{begin}\n" + "\n".join(lines[1:]) + f"\n{end}{whole.split(end)[1]}")


if __name__ == "__main__":
    {"take": lambda: take(sys.argv[2:]), "page": lambda: page(sys.argv[2])}[sys.argv[1]]()
