"""The raw half of the table of conduct: what counters, codes, returned points and bounds of libraries mean.

    python3 conduct.py measure FILE.json [METHOD…]   runs the methods that are installed, each run in its own process;
                                                     with names, the other rows of the file stay
    python3 conduct.py page FILE.json PAGE.md        writes the table between the marks of the page
    python3 conduct.py csv FILE.json                 prints it as CSV
    python3 conduct.py publish AUDIT.json PAGE.md    the table of Isoline's own methods, from `isoline audit --conduct`:
                                                     into benchmarks/published/conduct.json and the page

Each column is a function; its text has what is measured, the rule for ✓, and what to do at ✗. It returns whether the
rule holds, none where it cannot apply or where the last bits of r decide, and figures. Each cell names its runs, and the file has the record of each run.
"""
import contextlib
import csv
import datetime
import functools
import importlib
import json
import math
import os
import pathlib
import pickle
import re
import resource
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time

import inputs
import methods
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[3]
PUBLISHED = ROOT / "benchmarks/published/conduct.json"
SECONDS = 20  # of the processor, for one run
BUDGET = 10
FAR = 1e6
CLEAR, FEW, MANY = 1, 4, 10  # variants of the last bits of r, as they may decide


class Lost(Exception):
    """A run without an outcome: why."""


class Run:
    """A method on an input: its outcome, its calls, and the bytes that it printed."""

    def __init__(self, problem, outcome, printed):
        self.problem, self.outcome, self.printed = problem, outcome, printed
        self.calls, self.x = problem.calls, numpy.asarray(outcome.x, float).reshape(-1)
        self.loss = problem.loss_at(self.x)

    def best(self):
        return min((loss for _, loss in self.calls if loss == loss), default=numpy.inf)

    def is_evaluated(self):
        return any(bits == self.x.tobytes() for bits, _ in self.calls)

    def record(self):
        number = lambda value: float(value) if math.isfinite(value) else None
        return {"calls": len(self.calls), "own": self.outcome.own, "success": bool(self.outcome.success),
                "code": self.outcome.code, "x": [number(each) for each in self.x], "evaluated": self.is_evaluated(),
                "loss": number(self.loss), "best": number(self.best()), "bytes": self.printed}


def twice(method, problem, limit, in_threads):
    """Two runs in one process: their calls and their x must have the same bits."""
    both = [problem(), problem()]
    found = [None, None]

    def one(i):
        found[i] = method.run(both[i], limit)

    if in_threads:
        threads = [threading.Thread(target=one, args=(i,)) for i in range(2)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
    elif method.is_program():
        found = method.run(both, limit)
    else:
        one(0), one(1)
    same = found[0].x.tobytes() == found[1].x.tobytes() and both[0].calls == both[1].calls
    return same, [len(each.calls) for each in both]


def in_child(work):
    """What work() returns in a forked process, and the bytes that it printed; Lost where there is nothing."""
    result_read, result_write = os.pipe()
    with tempfile.TemporaryFile() as printed:
        child = os.fork()
        if child == 0:
            os.setpgid(0, 0)
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
            os.dup2(printed.fileno(), 1)
            os.dup2(printed.fileno(), 2)
            try:
                answer = (True, work())
            except inputs.Endless:
                answer = (False, "without end")
            except Exception as error:
                answer = (False, f"raised {type(error).__name__}")
            sys.stdout.flush()
            libc_flush()
            with os.fdopen(result_write, "wb") as file:
                pickle.dump(answer, file)
            os._exit(0)
        os.close(result_write)
        data, deadline = b"", time.monotonic() + 20 * SECONDS
        while time.monotonic() < deadline:
            if select.select([result_read], [], [], 0.5)[0]:
                more = os.read(result_read, 1 << 20)
                if not more:
                    break
                data += more
        else:
            data = None
        os.close(result_read)
        try:
            os.killpg(child, signal.SIGKILL)
        except ProcessLookupError:
            pass
        _, status = os.waitpid(child, 0)
        size = printed.seek(0, os.SEEK_END)
    if data is None or os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGXCPU:
        raise Lost(f"without end in {SECONDS} s")
    if not data:
        raise Lost("crashed")
    is_done, answer = pickle.loads(data)
    if not is_done:
        raise Lost(answer)
    return answer, size


def libc_flush():
    methods.ctypes.CDLL(None).fflush(None)


class Runs:
    """The runs of a method, each made once; those that a column asks for are noted."""

    def __init__(self, method):
        self.method, self.made, self.used = method, {}, []

    def of(self, name, limit=None, bits=0):
        key = name + (f" in {limit}" if limit else "") + (f", bits {bits}" if bits else "")
        if key not in self.used:
            self.used.append(key)
        if key not in self.made:
            try:
                self.made[key] = self.run(name, limit, bits)
            except Lost as lost:
                self.made[key] = lost
        if isinstance(self.made[key], Lost):
            raise self.made[key]
        return self.made[key]

    def run(self, name, limit, bits):
        if name in self.method.lost:
            raise Lost(self.method.lost[name])
        make = functools.partial(PROBLEMS[name](self.method), **({"bits": bits} if bits else {}))

        def work():
            problem = make()
            outcome = self.method.run(problem, limit)
            return problem.calls, outcome

        (calls, outcome), printed = in_child(work)
        problem = make()
        problem.calls = calls
        return Run(problem, outcome, printed)


PROBLEMS = {
    "line": lambda _: inputs.line,
    "E3": lambda _: inputs.decay,
    "E3s": lambda _: functools.partial(inputs.decay, 1e-6),
    "E3 small": lambda _: functools.partial(inputs.decay, factor=1e-3),
    "E3 within": lambda _: functools.partial(inputs.decay, bounds=(numpy.full(3, -FAR), numpy.full(3, FAR))),
    "RB": lambda _: inputs.valley,
    "RBb": lambda _: inputs.bounded_valley,
    "QD": lambda _: inputs.solved,
    "missing": lambda method: functools.partial(inputs.missing, method.takes == "residuals"),
}


def over_bits(column):
    """Repeats what is not clear with other last bits of r: where these do not agree, no rule holds or is broken."""
    @functools.wraps(column)
    def over(runs):
        holds, words, variants = column(runs, 0)
        used = list(runs.used)
        for bits in range(1, variants):
            runs.used = list(used)  # of runs that agree, the first ones are the record
            try:
                other, figures, _ = column(runs, bits)
            except Lost as lost:
                other, figures = False, str(lost)
            if other != holds:
                return None, f"{words}; with other last bits {figures}"
        runs.used = used
        return holds, words

    return over


def counts_equal(runs):
    """Calls by its own counter and by ours, on E3, and the first step without derivatives. ✓: equal. ✗: count in your
    own function."""
    run = runs.of("E3")
    steps = [step for step in (x - run.problem.start for x in run.problem.points()) if step.any()]
    first = f"; first step {numpy.linalg.norm(steps[0]):.2g}" if runs.method.differences and steps else ""
    if run.outcome.own is None:
        return None, f"none; {len(run.calls)} calls{first}"
    return run.outcome.own == len(run.calls), f"{run.outcome.own} of {len(run.calls)}{first}"


def calls_beyond(runs):
    """Calls beyond a budget of 10, on RB. ✓: 0. ✗: end the run from your own function, by an exception or the library's
    stop."""
    if not runs.method.has_limit:
        return None, "no limit of calls"
    beyond = max(0, len(runs.of("RB", BUDGET).calls) - BUDGET)
    return beyond == 0, f"{beyond}"


@over_bits
def returned_point(runs, bits):
    """Returned point on RB, at its own end and at a budget of 10. ✓: the best evaluated one, bitwise. ✗: keep the best
    point in your own function, and evaluate what is returned."""
    words, is_best, is_clear = [], True, False
    for limit in (None, BUDGET) if runs.method.has_limit else (None,):
        run = runs.of("RB", limit, bits)
        if not run.is_evaluated():
            words.append("never evaluated")
        elif run.loss > run.best():
            words.append(f"{run.loss - run.best():.1g} above the best")
        else:
            words.append("best")
        is_best &= words[-1] == "best"
        is_clear |= not run.is_evaluated() or run.loss - run.best() > 1e-3
    return is_best, "; ".join(words), CLEAR if is_clear else FEW


def started_at_solution(runs):
    """Started at the solution (QD). ✓: success after at most n + 2 calls, 2 n + 10 by differences. ✗: test the start
    yourself if calls are expensive."""
    run = runs.of("QD")
    most = 2 * run.problem.n + 10 if runs.method.differences else run.problem.n + 2
    claim = "" if run.outcome.success else "no success, "
    return run.outcome.success and len(run.calls) <= most, f"{claim}{run.outcome.code}, {len(run.calls)} calls"


@over_bits
def trial_without_value(runs, bits):
    """A trial without a value. ✓: ends at a point with a value. ✗: return a large finite number in its place."""
    run = runs.of("missing", bits=bits)
    words = f"{run.outcome.code}, x = {run.x[0]:.4g}"
    if all(loss == loss for _, loss in run.calls):
        return None, f"none met; {words}", CLEAR
    return bool(numpy.isfinite(run.loss)), words, FEW


def step_of(run):
    """The step of Gauss-Newton over each unknown, the largest, over those that no bound holds to 1e-6."""
    p, x = run.problem, run.x
    if p.own_loss:
        return abs(float(p.own_slope(x)[0]) * x[0])
    J, r = p.J(x), p.r(x)
    free = numpy.ones(p.n, bool)
    if p.bounds:
        slope = J.T @ r
        near = 1e-6 * numpy.maximum(abs(x), 1e-6)
        free = ~(((x <= p.bounds[0] + near) & (slope > 0)) | ((x >= p.bounds[1] - near) & (slope < 0)))
    if not (numpy.isfinite(J).all() and numpy.isfinite(r).all()):
        return numpy.inf
    step = numpy.linalg.lstsq(J[:, free], -r, rcond=None)[0]
    return max(abs(step) / numpy.maximum(abs(x[free]), 1e-6), default=0)


@over_bits
def claims_success(runs, bits):
    """Claims success on the line, E3, E3s, RB, RBb and where values are missing. ✓: only where the step of Gauss-Newton
    is below 1e-6 of each unknown. ✗: do not trust the code; tighten the tolerances, and look at the gradient."""
    claimed, wrong, clearly = 0, [], 0
    for name in ("line", "E3", "E3s", "RB", "RBb", "missing"):
        if name == "RBb" and not runs.method.keeps_bounds:
            continue
        try:
            run = runs.of(name, bits=bits)
        except Lost:
            continue
        claimed += run.outcome.success
        if run.outcome.success and not step_of(run) <= 1e-6:
            wrong.append(name)
            clearly += not step_of(run) <= 1e-4
    return not wrong, f"{claimed} claims" + (f", not so on {', '.join(wrong)}" if wrong else ""), CLEAR if clearly > 1 or not claimed else FEW


@over_bits
def outside(runs, bits):
    """Evaluations outside the bounds of RBb. ✓: 0. ✗: project x in your own function."""
    if not runs.method.keeps_bounds:
        return None, "takes no bounds", CLEAR
    run = runs.of("RBb", bits=bits)
    lower, upper = run.problem.bounds
    by = [max(float((lower - x).max()), float((x - upper).max())) for x in run.problem.points()]
    count = sum(each > 0 for each in by)
    return count == 0, f"{count} of {len(by)}" + (f", by up to {max(by):.2g}" if count else ""), CLEAR if count > 10 else FEW


@over_bits
def scales(runs, bits):
    """An unknown in units of 1e6 (E3s), and the loss times 1e-3. ✓: the same x to 1e-6, calls within 10 %. ✗: divide
    unknowns by their sizes, and the loss by its value at the start."""
    plain, words, is_same, is_clear = runs.of("E3", bits=bits), [], True, False
    for name, units in (("E3s", numpy.array([1, 1e6, 1])), ("E3 small", numpy.ones(3))):
        run = runs.of(name, bits=bits)
        off = float((abs(run.x / units - plain.x) / numpy.maximum(abs(plain.x), 1e-300)).max())
        share = len(run.calls) / len(plain.calls)
        is_same &= off <= 1e-6 and abs(share - 1) <= 0.1
        is_clear |= not off <= 1e-4 or not 0.5 <= share <= 2
        words.append(f"x off by {off:.1g}, {len(run.calls)} for {len(plain.calls)} calls")
    return is_same, "; ".join(words), CLEAR if is_clear else MANY


@over_bits
def loose_bound(runs, bits):
    """A bound that never binds (±1e6, on E3). ✓: at most 1.1 times the calls. ✗: pass only bounds that can bind."""
    if not runs.method.keeps_bounds:
        return None, "takes no bounds", CLEAR
    plain, within = len(runs.of("E3", bits=bits).calls), len(runs.of("E3 within", bits=bits).calls)
    return within <= 1.1 * plain, f"{within} for {plain}", MANY if 0.5 <= within / plain <= 2 else CLEAR


def second_run(runs):
    """A second run in one process, and two threads, on E3. ✓: the same bits. ✗: run each fit in a process of its own."""
    (same, _), _ = in_child(lambda: twice(runs.method, inputs.decay, None, False))
    words = "second run " + ("same" if same else "differs")
    if "threads" in runs.method.lost or runs.method.is_program():
        return same, f"{words}; threads {runs.method.lost.get('threads', 'not run: the library is in another process')}"
    try:
        for _ in range(MANY):  # the threads do not meet in each run
            (same_too, calls), _ = in_child(lambda: twice(runs.method, inputs.decay, None, True))
            if not same_too:
                break
    except Lost as lost:
        return False, f"{words}; threads {lost}"
    words += "; threads " + ("same" if same_too else f"differ: {calls[0]} and {calls[1]} calls")
    return same and same_too, words


def text_printed(runs):
    """Text on the user's terminal, on E3. ✓: none. ✗: redirect its output."""
    printed = runs.of("E3").printed
    return printed == 0, f"{printed} bytes"


COLUMNS = {
    "own counter": counts_equal, "beyond a budget": calls_beyond, "returned point": returned_point,
    "started at the solution": started_at_solution, "trial without a value": trial_without_value,
    "claims success": claims_success, "outside the bounds": outside, "scales": scales, "loose bound": loose_bound,
    "second run": second_run, "text": text_printed,
}


def versions():
    """Of the packages, as Debian names them."""
    names = ("python3-scipy", "python3-lmfit", "python3-iminuit", "libpetsc-real3.18", "libnlopt0", "libcminpack1",
             "liblbfgs0", "coinor-libipopt1v5", "r-base-core", "r-cran-minpack.lm", "r-cran-nloptr", "r-cran-minqa",
             "octave", "octave-optim", "libdlib19.1", "libalglib3.19", "libgsl27", "libceres3", "libpagmo8")
    command = ["dpkg-query", "-W", "-f", "${Package} ${Version}\n", *names]
    asked = subprocess.run(command, capture_output=True, text=True)
    return dict(line.split() for line in asked.stdout.splitlines())


def is_installed(method):
    with contextlib.suppress(ImportError):  # once, not in each process
        importlib.import_module({"scipy": "scipy.optimize"}.get(method.package, method.package))
    try:
        if method.is_program():  # which may be built now, without a limit
            method.run(inputs.solved(), None)
        in_child(lambda: method.run(inputs.solved(), None).code)
    except (Lost, OSError, RuntimeError, subprocess.CalledProcessError) as why:
        print(f"{method.name} is left out: {why}", file=sys.stderr)
        return False
    return True


def row_of(method):
    """The cells of a method, and the records of its runs."""
    runs, row = Runs(method), {}
    for name, column in COLUMNS.items():
        runs.used = []
        try:
            holds, words = column(runs)
        except Lost as lost:
            is_open = str(lost).startswith("not run") or column in (counts_equal, text_printed)
            holds, words = (None if is_open else False), str(lost)
        mark = "–" if holds is None else "✓" if holds else "✗"
        row[name] = {"mark": mark, "figures": words, "runs": runs.used}
        print(method.name, "|", name, "|", row[name]["mark"], words, file=sys.stderr)
    used = {key for cell in row.values() for key in cell["runs"]}
    return row, {key: {"lost": str(run)} if isinstance(run, Lost) else run.record() for key, run in runs.made.items() if key in used}


def measure(file, names):
    wanted = [each for each in methods.ALL if not names or each.name in names]
    path = pathlib.Path(file)
    known = json.loads(path.read_text()) if names and path.exists() else {"methods": {}, "runs": {}}
    for each in wanted:
        if is_installed(each):
            known["methods"][each.name], known["runs"][each.name] = row_of(each)
            write(path, known)


def write(path, known):
    in_order = lambda rows: {each.name: rows[each.name] for each in methods.ALL if each.name in rows}
    rules = {name: " ".join(column.__doc__.split()) for name, column in COLUMNS.items()}
    table = {"schema": "isoline.conduct/1", "origin": "raw", "date": str(datetime.date.today()),
             "packages": versions(), "rules": rules, "methods": in_order(known["methods"]), "runs": in_order(known["runs"])}
    text = json.dumps(table, ensure_ascii=False, separators=(",", ":"))
    names = "|".join(re.escape(json.dumps(each)) for each in [*table, *table["methods"]])
    path.write_text(re.sub(rf",({names}):", r",\n\1:", text) + "\n")  # a line for each method


def page(file, page):
    table = json.loads(pathlib.Path(file).read_text())
    lines = [f"Measured on {table['date']} with {', '.join(' '.join(each) for each in table['packages'].items())}.", ""]
    lines += ["| column | what is measured | ✓ | what to do at ✗ | ✓, ✗, – |", "|---|---|---|---|---|"]
    for name, rule in table["rules"].items():
        measured, holds, advice = re.split(r"\. ✓: |\. ✗: ", rule)
        marks = [row[name]["mark"] for row in table["methods"].values()]
        counts = ", ".join(str(marks.count(mark)) for mark in "✓✗–")
        lines.append(f"| {name} | {measured} | {holds} | {advice} | {counts} |")
    lines += ["", f"| method | {' | '.join(table['rules'])} |", "|---|" + "---|" * len(table["rules"])]
    for method, row in table["methods"].items():
        cells = [f"{row[name]['mark']} {row[name]['figures']}" for name in table["rules"]]
        lines.append(f"| {method} | {' | '.join(cells)} |")
    put(page, "conduct", lines)


def put(page, name, lines):
    """The lines, between the marks of this name."""
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    text = pathlib.Path(page).read_text()
    before, after = text.split(begin)[0], text.split(end)[1]
    pathlib.Path(page).write_text(f"{before}{begin}\n" + "\n".join(lines) + f"\n{end}{after}")


def own_lines(methods):
    """The rules, whose text is in reports/words/conduct.txt, and the marks of Isoline's own methods."""
    columns = [cell["column"] for cell in methods[0]["conduct"]]
    text = re.sub(r"\n  ", " ", (ROOT / "reports/words/conduct.txt").read_text())
    part = lambda column, name: re.search(
        rf"^conduct-{column.replace(' ', '-')}:\n(?:\..*\n)*?\.{name}: (.*)$", text, re.MULTILINE)[1]
    mark = lambda cell: {True: "✓", False: "✗", None: "–"}[cell.get("holds")]
    lines = ["| column | what is measured | ✓ | why it may not hold | what to do at ✗ | ✓, ✗, – |", "|---|---|---|---|---|---|"]
    for i, column in enumerate(columns):
        marks = [mark(method["conduct"][i]) for method in methods]
        words = " | ".join(part(column, name) for name in ("measured", "rule", "reason", "advice"))
        lines.append(f"| {column} | {words} | {', '.join(str(marks.count(each)) for each in '✓✗–')} |")
    lines += ["", f"| method | {' | '.join(columns)} |", "|---|" + "---|" * len(columns)]
    for method in methods:
        cells = [f"{mark(cell)} {cell['figures']}" for cell in method["conduct"]]
        lines.append(f"| {method['name']} | {' | '.join(cells)} |")
    return lines


def publish(file, page):
    audit = json.loads(pathlib.Path(file).read_text())
    methods = [each for each in audit["optimizers"] if each.get("conduct")]
    audit["optimizers"] = [{"name": each["name"], "spec": each["name"], "conduct": each["conduct"],
                            "reason": "conduct alone"} for each in methods]
    text = json.dumps(audit, ensure_ascii=False, separators=(",", ":")).replace('},{"name"', '},\n{"name"')
    PUBLISHED.write_text(text + "\n")
    put(page, "own conduct", own_lines(methods))


def print_csv(file):
    table = json.loads(pathlib.Path(file).read_text())
    out = csv.writer(sys.stdout)
    out.writerow(["method", "column", "mark", "figures", "runs"])
    for method, row in table["methods"].items():
        out.writerows([method, name, cell["mark"], cell["figures"], "; ".join(cell["runs"])] for name, cell in row.items())


if __name__ == "__main__":
    verb, file, *more = sys.argv[1:]
    {"measure": lambda: measure(file, more), "page": lambda: page(file, *more), "publish": lambda: publish(file, *more), "csv": lambda: print_csv(file)}[verb]()
