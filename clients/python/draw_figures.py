"""Draws the plots of a report for papers: SVG, PDF and PGF by matplotlib, and their points as CSV.

    isoline figures results/quick --only curves-heat --format pdf,csv

or, to change fonts and colours in a copy of this file:

    python3 draw_figures.py results/quick/report/report.json --out figures --format pdf

The numbers are those of report.json. Labels have 7 points and more at the width of a column.
"""

import argparse
import contextlib
import csv
import json
import math
import os
import pathlib
import re
import shutil
import sys
import textwrap
import unicodedata

import isoline

# Okabe and Ito (2008), as on the page.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#B85A90", "#B57700", "#2F8FC9", "#5B4BB5", "#555555"]
GOAL, TAU = "#A8201A", "#5D666F"
STYLE = {
    "font.size": 8, "axes.labelsize": 8, "axes.titlesize": 8, "xtick.labelsize": 7, "ytick.labelsize": 7,
    "legend.fontsize": 7, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
    "axes.linewidth": 0.5, "grid.linewidth": 0.5, "grid.color": "#D5D8DC", "lines.linewidth": 1,
    "svg.fonttype": "none", "svg.hashsalt": "isoline", "pdf.fonttype": 42,
    "pgf.texsystem": "pdflatex", "pgf.rcfonts": False}
COMMANDS = {"−": "-", "–": "--", "≤": r"\le", "≥": r"\ge", "×": r"\times", "±": r"\pm", "≈": r"\approx",
            "‖": r"\Vert", "∇": r"\nabla", "∂": r"\partial", "·": r"\cdot", "†": r"\dagger", "‡": r"\ddagger",
            "→": r"\to", "√": r"\surd", "∞": r"\infty", "½": r"\frac{1}{2}", "²": "^2", "⁻": "^{-}",
            "¹": "^1", "₀": "_0", "₁": "_1", "ᵀ": "^T", "∈": r"\in", "§": r"\S", "°": r"^\circ"}


def in_tex(text):
    """The text for LaTeX: Greek letters and marks as mathematics, other letters without accents."""
    shown = ""
    for letter in text:
        if letter.isascii():
            shown += letter
            continue
        name = unicodedata.name(letter, "").split()
        if letter in COMMANDS:
            shown += f"${COMMANDS[letter]}$"
        elif name[:3:2] == ["GREEK", "LETTER"]:
            command = name[3].lower().replace("lamda", "lambda")
            shown += f"$\\{command.capitalize() if name[1] == 'CAPITAL' else command}$"
        elif letter == "…":
            shown += "..."
        else:
            shown += "".join(one for one in unicodedata.normalize("NFKD", letter) if one.isascii())
    return shown


def numbers(line, name):
    return [float(value) for value in line.get(name, [])]


def names_of(line):
    """What a reader may call its method: with its options and marks, or without."""
    return {line["name"], re.split(r"[\[ ,]", line["name"])[0]}


def shown_lines(plot, methods):
    """The lines of these methods, with or without their options; else those that the page shows."""
    if methods:
        return [line for line in plot["series"] if names_of(line) & methods]
    return [line for line in plot["series"] if not line.get("hidden")] or plot["series"]


def add_line(axes, plot, line, place):
    x, y = numbers(line, "x"), numbers(line, "y")
    colour, is_stair = COLOURS[place % len(COLOURS)], plot["join"] == "steps"
    if is_stair and plot["kind"] == "steps" and x:  # the last value holds
        x, y = [*x, plot["window"][1]], [*y, y[-1]]
    low, high = numbers(line, "low"), numbers(line, "high")
    if low and low != high and len(low) == len(line["x"]):
        axes.fill_between(numbers(line, "x"), low, high, color=colour, alpha=0.15, linewidth=0,
                          step="post" if is_stair else None)
    marker, dash = line.get("marker", "o" if plot["join"] == "none" else ""), line.get("dash", "none")
    if plot["join"] == "none" or sum(map(math.isfinite, y)) == 1:
        return axes.plot(x, y, marker or "o", markersize=2, color=colour, zorder=3)[0]
    style = "-" if dash == "none" else (0, [float(length) / 2 for length in dash.split()])
    return axes.plot(x, y, drawstyle="steps-post" if is_stair else "default", color=colour, linestyle=style,
                     marker=marker, markersize=3, markevery=marked(plot, x, y, place), zorder=3)[0]


def marked(plot, x, y, place):
    """The points that carry a marker, as on the page. By lengths, matplotlib would list those outside of the window,
    which are without end where a path diverges."""
    left, right, bottom, top = map(float, plot["window"])
    left, right = limits(left, right, plot["log_x"])
    along = math.log if plot["log_x"] else float
    quarter = (along(right) - along(left)) / 4
    return sorted({math.floor((along(x[i]) - along(left)) / quarter - 0.618 * place % 1): i
                   for i in range(len(x)) if left <= x[i] <= right and bottom <= y[i] <= top}.values())


def add_published(axes, mark):
    x, y = numbers(mark, "x"), numbers(mark, "y")
    if len(x) > 1 and y:
        axes.plot(x, y, color=GOAL, linestyle=(0, (3, 3)), linewidth=0.5)
    elif len(x) == 1 and y:
        low, high = numbers(mark, "low") or [math.nan], numbers(mark, "high") or [math.nan]
        if math.isfinite(low[0]) and math.isfinite(high[0]):
            axes.vlines(x, low, high, color=GOAL, linewidth=1.5, zorder=4)
        axes.plot(x, y, "o", markersize=3, color=GOAL, zorder=4)


def limits(low, high, is_log):
    """A logarithmic axis begins above zero."""
    return (low if low > 0 else high * 1e-6, high) if is_log else (low, high)


def beside(pyplot, plots, width, methods, text):
    """A figure of several plots, side by side."""
    whole = pyplot.figure(figsize=(len(plots) * width, 1.2 * width))
    parts = iter(whole.subfigures(1, len(plots), squeeze=False)[0])
    for plot in plots:
        drawn(lambda **_: next(parts), plot, width, methods, text).suptitle(text(plot["title"]), fontsize=8)
    return whole


def drawn(figure_of, plot, width, methods, text):
    """A figure of one plot: axes, lines, published values, and names below."""
    lines = shown_lines(plot, methods)
    names = [text(textwrap.shorten(line["name"], 50, placeholder="…")) for line in lines]
    columns = 2 if all(len(name) <= 22 for name in names) else 1
    below = 0.42 + 0.14 * math.ceil(len(names) / columns)  # inches for the axis and the names
    height = below + 0.54 * width + 0.2
    figure = figure_of(figsize=(width, height))
    axes = figure.add_axes([0.5 / width, below / height, 1 - 0.6 / width, 0.54 * width / height])
    left, right, bottom, top = map(float, plot["window"])
    axes.set_xscale("log" if plot["log_x"] else "linear")
    axes.set_yscale("log" if plot["log_y"] else "linear")
    for line in plot.get("ground", []):
        axes.plot(numbers(line, "x"), numbers(line, "y"), color=TAU, linestyle=(0, (1, 2)), linewidth=0.5)
    if "goal" in plot:
        axes.axhline(plot["goal"], color=TAU, linewidth=0.5)
    handles = [add_line(axes, plot, line, place) for place, line in enumerate(lines)]
    for mark in plot.get("published", []):
        add_published(axes, mark)
    for end in plot.get("ends", []):  # the start is open, the goal is full
        axes.plot(numbers(end, "x"), numbers(end, "y"), "o", markersize=4, color="black", zorder=4,
                  fillstyle="none" if end["name"] == "start" else "full")
    axes.set_xlim(*limits(left, right, plot["log_x"]))
    axes.set_ylim(*limits(bottom, top, plot["log_y"]))
    if plot.get("to_scale"):
        axes.set_aspect("equal", adjustable="datalim")
    if plot["kind"] == "steps":
        axes.yaxis.set_major_formatter(lambda share, _: text(f"{100 * share:.0f} %"))
    axes.set_xlabel(text(plot["x_label"]))
    axes.set_title(text(plot["y_label"]), loc="left")
    figure.legend(handles, names, loc="lower left", ncol=columns, frameon=False, borderaxespad=0.2,
                  labelspacing=0.15)
    return figure


def field_plots(folders, plots, methods):
    """A plot of y*, x* and the stored x of up to four methods for each problem whose records have fields: those of the
    least seed, and of several runs of a method that of least loss."""
    runs = {}
    for path in sorted(path for folder in folders for path in pathlib.Path(folder, "runs").glob("*.npy")):
        record = path.with_suffix(".json")
        if path.name.endswith(".x.npy") or not record.is_file():
            continue
        try:
            record = json.loads(record.read_text(encoding="utf-8"))
            request = record["request"]
            key = int(request["seed"]), float(record["summary"].get("best_loss") or math.inf)
            mine = runs.setdefault(str(request["problem"]["spec"]), {})
            name = str(request["optimizer"]["name"])
            if name not in mine or key < mine[name][0]:
                mine[name] = key, path, record["fields"]
        except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
            print(f"left out: {path}: its record cannot be read", file=sys.stderr)
    for plot in [plot for plot in plots if plot["name"].startswith("curves-") and plot.get("problem") in runs]:
        names = dict.fromkeys(name for line in shown_lines(plot, methods) for name in sorted(names_of(line), key=len)[:1])
        found = {name: runs[plot["problem"]][name] for name in names if name in runs[plot["problem"]]}
        if found:
            yield {"name": plot["name"].replace("curves-", "fields-"), "title": f"stored x on {plot['problem']}",
                   "kind": "fields", "series": [], "found": dict(list(found.items())[:4])}


def drawn_fields(pyplot, plot, width, text):
    """A row of pictures for y* and x*, and a row for each method, at the iterations that it stored."""
    import numpy
    rows = []
    for method, (_, path, fields) in plot["found"].items():
        try:
            planes = numpy.load(path).reshape(fields["shape"])
        except Exception:  # of a damaged header, numpy raises whatever its parser raises
            sys.exit(f"{path} cannot be read as an array of the shape that its record states")
        count, last = len(fields["iterations"]), len(planes)
        first = 1 if last == count + 1 else 2
        rows = rows or [[("y*", planes[0]), ("x*", planes[1])][:first]]
        rows.append([(str(k), planes[first + i]) for i, k in enumerate(fields["iterations"])])
    columns, heads = max(map(len, rows)), 0.3  # inches above each row
    height = (width / columns + heads) * len(rows)
    figure, all_axes = pyplot.subplots(len(rows), columns, squeeze=False, figsize=(width, height))
    scale = numpy.nanmax(numpy.abs(rows[0][-1][1])) or 1
    for axes, (label, values) in [(all_axes[r][c], one) for r, row in enumerate(rows) for c, one in enumerate(row)]:
        most = scale if label != "y*" else numpy.nanmax(numpy.abs(values)) or 1
        axes.imshow(values, cmap="PuOr_r", vmin=-most, vmax=most, aspect="auto")
        axes.set_title(text(label), fontsize=7, pad=1.5)
    for method, axes in zip(plot["found"], all_axes[1:, 0]):
        axes.annotate(text(method), (0, 1), (0, 10), "axes fraction", textcoords="offset points", fontsize=7)
    for axes in all_axes.flat:
        axes.set_axis_off()
    figure.subplots_adjust(0.01, 0.01, 0.99, 1 - heads / height, 0.05, heads * columns / width)
    return figure


def write_points(file, plot):
    with open(file, "w", newline="", encoding="utf-8") as out:
        rows = csv.writer(out)
        rows.writerow(["line", "x", "y", "low", "high"])
        published = [{**mark, "name": f"published, {mark['name']}"} for mark in plot.get("published", [])]
        for line in [*plot["series"], *published]:
            columns = [numbers(line, name) for name in ("x", "y", "low", "high")]
            for i in range(len(columns[0])):
                cells = [column[i] if i < len(column) else math.nan for column in columns]
                rows.writerow([line["name"], *("" if math.isnan(value) else repr(value) for value in cells)])


def read_report(path):
    """The JSON of a report, or an exit that names the file and what it lacks."""
    try:
        if not os.path.isfile(path):
            sys.exit(f"{path}: no such file")
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
    except (OSError, ValueError, RecursionError):
        sys.exit(f"{path} is not JSON in UTF-8; `isoline report` writes report.json")
    plots = report.get("plots") if isinstance(report, dict) else None
    if not isinstance(plots, list):
        sys.exit(f"{path} is not the JSON of a report: it has no list of plots")
    for number, plot in enumerate(plots, 1):
        with named(path, number):
            require_plot(plot)
    return report


@contextlib.contextmanager
def named(path, plot):
    """Where a value of the plot cannot be used, an exit that names it and the file."""
    try:
        yield
    except (LookupError, TypeError, ValueError, AttributeError, OverflowError) as error:
        why = f"{error.args[0]} is missing" if isinstance(error, KeyError) else "a value has another type or size than expected"
        sys.exit(f"{path}: plot {plot} cannot be drawn: {why}")


def require_plot(plot):
    """What drawn() uses of a plot, with sizes that can be drawn."""
    if not re.fullmatch(r"[\w.+-]{1,200}", plot["name"]) or plot["name"].startswith("."):
        raise ValueError  # it names a file
    texts = [plot[each] for each in ("title", "x_label", "y_label", "join", "kind")]
    lines = [*plot["series"], *plot.get("published", [])]
    if not all(isinstance(each, str) and len(each) <= 1000 for each in [*texts, *(line["name"] for line in lines)]):
        raise ValueError
    window = [float(plot["window"][place]) for place in range(4)]
    is_log = plot["log_x"], plot["log_x"], plot["log_y"], plot["log_y"]
    for value, follows in zip(window, is_log):
        if not math.isfinite(value) or abs(value) > 1e300 or follows and 0 < value < 1e-300:
            raise ValueError
    if not (window[0] < window[1] and window[2] < window[3]) or plot["log_x"] and window[1] <= 0 or plot["log_y"] and window[3] <= 0:
        raise ValueError
    if "goal" in plot and not math.isfinite(float(plot["goal"])):
        raise ValueError
    for line in [*lines, *plot.get("ground", []), *plot.get("ends", [])]:
        x, y, low, high = (numbers(line, each) for each in ("x", "y", "low", "high"))
        if len(y) not in (len(x), 0 if line not in plot["series"] else len(x)) or len(low) != len(high):
            raise ValueError


def caption(plot, report, methods):
    """What a paper has to say below the figure: what is drawn, of how many runs, and by which program."""
    lines = shown_lines(plot, methods)
    sentences = [f"{plot['title']}.", plot.get("reading", ""), plot.get("caption", ""),
                 "Lines are medians over seeds." if plot["kind"] == "lines" and lines and "problem" in plot else "",
                 "The numbers are iterations; all x have one scale." if plot["kind"] == "fields" else "",
                 f"Data: {report.get('headline', '')}; seeds {', '.join(map(str, report.get('seeds', [])))}; {report.get('version', '')}."]
    return " ".join(sentence for sentence in sentences if sentence)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("report", help="report.json of a report")
    parser.add_argument("--format", default="svg", help="svg, pdf, pgf and csv, between commas")
    parser.add_argument("--only", default="", help="plots whose names contain this text")
    parser.add_argument("--records", action="append", default=[], help="result folder, whose stored fields are drawn")
    parser.add_argument("--methods", default="", help="methods, by name, between commas")
    parser.add_argument("--width", type=float, default=3.2, help="width in inches")
    parser.add_argument("--out", default="figures", help="output folder")
    parser.add_argument("--beside", action="store_true", help="also beside.FORMAT, all in one figure, side by side")
    parser.add_argument("--list", action="store_true", help="list names and titles, and write nothing")
    parser.add_argument("--quiet", action="store_true", help="print nothing")
    given = parser.parse_args()
    report = read_report(given.report)
    methods = {name for name in given.methods.split(",") if name}
    all_plots = [*report["plots"], *field_plots(given.records, report["plots"], methods)]
    plots = [plot for plot in all_plots if given.only in plot["name"]]
    if not report["plots"] and not given.quiet:
        sys.exit("these results have no figures")
    if not plots and report["plots"]:
        sys.exit(f"--only {given.only}: none of the {len(all_plots)} figure names contains this text; "
                 "--list prints their names")
    if given.list:
        for plot in plots:
            print(f"{plot['name']:40} {plot['title']}")
        return
    formats = given.format.split(",")
    if "pgf" in formats and shutil.which("pdflatex") is None:
        sys.exit("--format pgf: matplotlib measures the texts of PGF by pdflatex, which is not installed; on Debian, "
                 "`apt-get install texlive-latex-base texlive-pictures` installs it")
    unknown = methods - {name for plot in report["plots"] for line in plot["series"]
                         for name in names_of(line)}
    if unknown:
        sys.exit(f"--methods {min(unknown)}: these figures have no line of this name")
    out = pathlib.Path(given.out)
    out.mkdir(parents=True, exist_ok=True)
    drawings = [name for name in formats if name != "csv"]
    if drawings:
        matplotlib = isoline.package("matplotlib", "python3-matplotlib")
        matplotlib.use("agg")
        from matplotlib import pyplot
        pyplot.rcParams.update(STYLE)
    with open(out / "captions.txt", "w", encoding="utf-8") as file:
        for plot in plots:
            with named(given.report, plot["name"]):
                file.write(f"{plot['name']}: {caption(plot, report, methods)}\n\n")
    for plot in plots:
        is_of_fields = plot["kind"] == "fields"
        if "csv" in formats and not is_of_fields:
            write_points(out / f"{plot['name']}.csv", plot)
        for name in drawings:
            text = in_tex if name == "pgf" else lambda text: text
            plain = {"svg": {"Date": None, "Title": plot["title"]},
                     "pdf": {"CreationDate": None, "Title": plot["title"]}}
            with named(given.report, plot["name"]):
                figure = (drawn_fields(pyplot, plot, given.width, text) if is_of_fields else
                          drawn(pyplot.figure, plot, given.width, methods, text))
                figure.savefig(out / f"{plot['name']}.{name}", metadata=plain.get(name))
                pyplot.close(figure)
    lines = [plot for plot in plots if plot["kind"] != "fields"]
    for name in drawings if given.beside and lines else []:
        with named(given.report, lines[0]["name"]):
            figure = beside(pyplot, lines, given.width, methods, in_tex if name == "pgf" else str)
            figure.savefig(out / f"beside.{name}", metadata={"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(name))
    if not given.quiet:
        print(f"{out}: {len(plots)} figure{'' if len(plots) == 1 else 's'} as {', '.join(formats)}")


if __name__ == "__main__":
    main()
