"""isoline.fit: parameters of a function, with uncertainties, from data. Requires NumPy.

The program `isoline` looks for the parameters. It starts bridge.py, which passes its socket on to this process,
so `forward` may be any function, such as a closure in a notebook.

Notation: z (n) are the unknowns of the method: the free ones of x (k), or their logarithms. r = ((y - data)/σ,
(x - mean)/sd of priors) (m); J = ∂r/∂z (m, n); S = ‖r‖² = 2 L; s² = S/ν; ν = m minus the z that no bound holds.
"""

import csv
import hashlib
import html
import inspect
import io
import json
import math
import os
import random
import select
import shlex
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

import numpy as np

import isoline
from isoline import Refused

METHOD, CENTRAL = "levenberg-marquardt[jacobian=differences]", "levenberg-marquardt"
MOST_ATTEMPTS = 6  # of the default methods, until a point is a confirmed minimum
FITS = ("converged", "target", "discrepancy")  # statuses of a point that Isoline has examined
LEVEL, LEAST_P = 0.95, 0.001  # of intervals; of the χ² test, below which the model contradicts σ


# --- data


class Data:
    """Columns by name, data["t"] (m), of which y (m) is fitted. sigma (m) or None; x: the name of another column, or None."""

    def __init__(self, columns, y, sigma):
        self.columns, self.y, self.y_name, self.sigma = columns, columns[y], y, columns.get(sigma)
        self.x = next((name for name in columns if name not in (y, sigma)), None)

    def __getitem__(self, name):
        return self.columns[name]


def read_data(source, y="y", sigma="sigma"):
    """Data from a CSV file with a header (a path) or from a frame of pandas.

    y: the column of measured values. sigma: that of their standard deviations, in units of y, if there is one.
    Raises Refused, with the line, for a missing value, and for a word that is not a number, in any column.
    """
    is_file = isinstance(source, (str, os.PathLike))
    rows = _rows_of_file(source) if is_file else _rows_of_frame(source)
    names = next(rows)
    if names.count(y) != 1 or len(set(names)) < len(names):
        raise Refused(f"{source if is_file else 'the data'} must have one column {y!r} and no name twice, "
                      f"got {', '.join(names)[:200]}; y= sets another name")
    columns = []
    for place, row in rows:
        if len(row) != len(names):
            raise Refused(f"{place}: expected {len(names)} fields, as in the header, found {len(row)}")
        columns.append([_datum(word, f"{place}, column {name}") for name, word in zip(names, row)])
    return Data(dict(zip(names, np.array(columns).reshape(-1, len(names)).T)), y, sigma)


def _rows_of_file(path):
    with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:
        header = file.readline()
        mark = next((mark for mark in ";\t" if mark in header), ",")
        yield [name.strip() for name in header.split(mark)]
        reader = csv.reader(file, delimiter=mark)
        try:
            yield from ((f"{path}, line {reader.line_num + 1}", row) for row in reader if row)
        except csv.Error:
            raise Refused(f"{path}, line {reader.line_num + 1}: expected fields of at most {csv.field_size_limit()} characters, "
                          "in lines that end by a line feed; an open quote joins lines") from None


def _rows_of_frame(frame):
    yield [str(name) for name in frame.columns]
    yield from ((f"row {row[0]!r}", row[1:]) for row in frame.itertuples())


def _datum(word, place):
    try:
        value = isoline._number(word.strip(), place) if isinstance(word, str) else float(word)
    except (TypeError, ValueError, RuntimeError):
        value = math.nan
    if not math.isfinite(value):
        raise Refused(f"{place}: expected a number, found {str(word).strip() or 'an empty field'}; complete or remove this row")
    return value


# --- the model


class _Model:
    """r(z) in this process: counts the calls of forward, and shows progress."""

    def __init__(self, forward, data, x0, sigma, bounds, names, units, fixed, tied, log, weights, prior, progress):
        if isinstance(data, (str, os.PathLike)) or hasattr(data, "itertuples"):
            data = read_data(data)
        self.table = data if isinstance(data, Data) else None
        if self.table:
            data, sigma = data.y, data.sigma if sigma is None else sigma
        if isinstance(x0, dict):
            names, x0 = list(x0), list(x0.values())
        self.forward, self.progress = forward, progress
        self.data = np.array([_datum(each, f"data[{i}]") for i, each in enumerate(isoline._column(data, "data"))])
        self.x0 = isoline._column(x0, "x0").copy()
        count = len(self.x0)
        names = isoline._labels(names or getattr(forward, "names", None), count, "names")
        self.names = names or [f"x{i + 1}" for i in range(count)]
        self.units = isoline._labels(units, count, "units") or [""] * count
        self.sigma = None if sigma is None else _spread(sigma, len(self.data), "sigma")
        if sigma is not None and not min(self.sigma) > 0:
            raise Refused("sigma must be positive: the standard deviation of each datum, in units of the data")
        self.factor = 1.0 if self.sigma is None else 1 / self.sigma  # of the residuals of the data
        if weights is not None:
            self.factor = _spread(weights, len(self.data), "weights")
            if self.sigma is not None or not min(self.factor) > 0:
                raise Refused("weights must be positive factors of the residuals, and exclude sigma")
        for which, value in fixed.items() if isinstance(fixed, dict) else ():
            self.x0[self.index(which)] = value
        self.tied = {self.index(which): compile(words.replace("^", "**"), f"tied[{which!r}]", "eval")
                     for which, words in (tied or {}).items()}
        self.prior = {self.index(which): (float(mean), float(sd)) for which, (mean, sd) in (prior or {}).items()}
        if self.prior and self.sigma is None:
            raise Refused("prior requires sigma: without it, the weight of the data beside the prior is unknown")
        self.fixed = {self.index(which) for which in fixed}
        self.free = [i for i in range(count) if i not in self.fixed and i not in self.tied]
        self.is_log = np.isin(self.free, [self.index(which) for which in log])
        lower, upper = (_spread(side, count, "bounds") for side in bounds or (-math.inf, math.inf))
        for i in self.free:
            if not lower[i] <= self.x0[i] <= upper[i] or i in map(self.index, log) and not self.x0[i] > 0:
                limits = f"its bounds {lower[i]:g} and {upper[i]:g}"
                raise Refused(f"x0 of {self.names[i]} is {self.x0[i]:g}; it must lie in {limits}, and be positive for log=")
        self.is_free = np.isin(range(count), self.free)
        self.bounds = np.where(self.is_free, lower, -math.inf), np.where(self.is_free, upper, math.inf)
        self.lower, self.upper, self.z0 = self.z_of(lower), self.z_of(upper), self.z_of(self.x0)
        axis = self.table and isoline._axis(self.table)
        self.words = isoline._words(self.names, count, fixed, tied, log, sigma, weights, prior, axis=axis)
        self.calls, self.least, self.shown, self.lock = 0, math.inf, time.monotonic(), threading.Lock()
        self.target = np.append(self.data * self.factor, [0.0] * len(self.prior))

    def index(self, which):
        if which not in self.names and which not in range(len(self.names)):
            raise Refused(f"there is no unknown {which!r}; there are {', '.join(self.names)}")
        return self.names.index(which) if which in self.names else which

    def z_of(self, x):
        x = np.asarray(x, float)[self.free]
        with np.errstate(divide="ignore"):
            return np.where(self.is_log, np.log(np.where(self.is_log, np.maximum(x, 0), 1)), x)

    def outer(self, j, value):
        """z_j in the unit of its unknown."""
        return math.exp(min(value, 709)) if self.is_log[j] else value  # e^709 is a double, e^710 is not

    def x_of(self, z):
        x = self.x0.copy()  # (k)
        x[self.free] = [self.outer(j, value) for j, value in enumerate(z)]
        for i, words in self.tied.items():
            x[i] = eval(words, {"__builtins__": {}}, {**vars(math), **dict(zip(self.names, x))})
        return x

    def inside(self, z):
        """x_of(z), in the bounds: the exponential of a logarithm may be a digit off."""
        return np.clip(self.x_of(z), *self.bounds)

    def y(self, x):
        found = isoline._column(self.forward(x.copy()), "forward(x)")
        if len(found) != len(self.data):
            raise Refused(f"forward(x) must return a number for each of the {len(self.data)} data, got {len(found)}")
        return found

    def answer(self, x):
        """forward(x), counted."""
        with self.lock:
            self.calls += 1
        y = self.y(x)
        r = self.rows(x, y)
        self.show(r @ r / 2)
        return y

    def rows(self, x, y):
        """r: those of the data, over σ or times their weight, then the terms of priors (m)."""
        return np.append((y - self.data) * self.factor, [(x[i] - mean) / sd for i, (mean, sd) in self.prior.items()])

    def residual(self, z):
        """r (m); None where forward fails."""
        x = self.x_of(z)
        try:
            r = self.rows(x, self.answer(x))
        except Exception:
            return None
        return r if np.isfinite(r @ r) else None

    def column(self, z, j, step, r):
        """∂r/∂z_j (m) at z by central differences inside the bounds, with r there; zeros where forward fails around z."""
        for size in (step, step / 2, 2 * step):
            ends = []
            for sign in (1, -1):
                moved = z.copy()
                moved[j] = min(max(z[j] + sign * size, self.lower[j]), self.upper[j])
                there = self.residual(moved) if moved[j] != z[j] else None
                ends += [] if there is None else [(moved[j], there)]
            if ends:
                (a, ra), (b, rb) = (*ends, (z[j], r))[:2]
                return (ra - rb) / (a - b)
        return np.zeros(len(r))

    def show(self, loss, is_last=False):
        self.least = min(self.least, loss)
        is_terminal = sys.stderr.isatty() or "ipykernel" in sys.modules  # where a line can be written again
        if self.progress and (is_last or time.monotonic() > self.shown + (0.2 if is_terminal else 10)):
            self.shown = time.monotonic()
            begin, end = ("\r", "\n" if is_last else "") if is_terminal else ("", "\n")
            print(f"{begin}{self.calls} calls, least loss {self.least:.6g}", end=end, file=sys.stderr, flush=True)

    def key(self, y0):
        """A digest of what identifies the fit; of forward, its value at x0 and its text count."""
        try:
            text = inspect.getsource(self.forward)
        except (TypeError, OSError):
            text = ""
        tied = [(i, words.co_code, words.co_consts, words.co_names) for i, words in self.tied.items()]
        arrays = [y0, self.target, np.atleast_1d(self.factor), self.x0, self.z0, self.lower, self.upper, self.is_log]
        parts = [None if each is None else list(each) for each in arrays]
        parts += [self.names, self.units, tied, self.prior, self.free, text]
        return hashlib.sha1(repr(parts).encode()).hexdigest()[:12]


def _spread(values, count, name):
    """One number for each of `count`, from one or as many."""
    found = isoline._column(values, name)
    if len(found) not in (1, count):
        raise Refused(f"{name} must be one number or {count} numbers, got {len(found)}")
    return np.broadcast_to(found, count)


# --- the run of the program


def _program():
    """The command `isoline`: the one that ISOLINE names, the one of this file's tree or installation, or of PATH."""
    here = os.path.dirname(os.path.abspath(__file__))
    beside = [os.path.normpath(os.path.join(here, way)) for way in ("../../isoline", "../../../bin/isoline")]
    for path in (os.environ.get("ISOLINE"), *beside, shutil.which("isoline")):
        if path and os.path.isfile(path) and os.access(path, os.X_OK):
            return path
    raise Refused("the program isoline was not found; add its folder to PATH, or set ISOLINE to its path")


class _Conversation:
    """One copy of the problem: its socket to Isoline, and the bridge that passed it on."""

    def __init__(self, bridge, descriptor, description, products, sizes):
        self.bridge, self.line = bridge, isoline._Line(descriptor)
        self.points, self.description, self.products, self.sizes = {}, description, products, sizes

    def step(self):
        """Answers one request; False after the last one."""
        try:
            if self.description:
                greeting = json.loads(bytes(self.line.receive()[2]))
                isoline._introduce(self.line, greeting, "problem", self.description(int(greeting.get("seed", 0))))
                self.description = None
            else:
                isoline._reply(self.line, self.points, self.products, None, None, *self.sizes)
            return True
        except (isoline.Stop, OSError):
            self.close()
            return False

    def close(self):
        self.line.socket.close()
        self.bridge.close()


def _run(words, workers, *problem):
    """Runs Isoline, and answers its evaluations. Returns the exit code and what it printed."""
    isoline._remove_abandoned()
    folder = tempfile.mkdtemp(prefix=f"{isoline._folder_prefix()}{os.getpid()}-")  # no other user can connect
    path, open_lines, printed = os.path.join(folder, "socket"), {}, b""
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(path)
        listener.listen()
        program = subprocess.Popen(
            words, env=dict(os.environ, ISOLINE_FIT=path), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, start_new_session=True,
        )
        try:
            while True:
                for ready in select.select([listener, program.stdout, *open_lines], [], [])[0]:
                    if ready is program.stdout:
                        more = os.read(ready.fileno(), 1 << 16)
                        printed = (printed + more)[-(1 << 16):]
                        if not more:
                            return program.wait(), printed.decode(errors="replace")
                    elif ready is listener:
                        bridge, _ = listener.accept()
                        _, descriptors, *_ = socket.recv_fds(bridge, 1, 1)
                        if not descriptors:  # Isoline has ended it
                            bridge.close()
                            continue
                        one = _Conversation(bridge, descriptors[0], *problem)
                        if workers > 1:
                            threading.Thread(target=all, args=(iter(one.step, False),), daemon=True).start()
                        else:
                            open_lines[one.line.socket] = one
                    elif not open_lines[ready].step():
                        del open_lines[ready]
        finally:
            if program.poll() is None:
                program.terminate()  # the first SIGINT would let its run end
                program.wait()
            program.stdout.close()
            for one in open_lines.values():
                one.close()
            shutil.rmtree(folder, ignore_errors=True)


def _starts(model, count):
    """z of each start: x0, then a Latin hypercube over the bounds."""
    chosen = random.Random(0)
    if count > 1 and not np.all(np.isfinite(model.upper - model.lower)):
        raise Refused("starts requires finite bounds of every free unknown, above 0 for log=")
    cells = np.array([chosen.sample(range(count - 1), count - 1) for _ in model.free]).T
    return [model.z0] + [model.lower + (model.upper - model.lower) * (row + chosen.random()) / (count - 1) for row in cells]


def fit(
    forward, data, x0, sigma=None, bounds=None, names=None, units=None, methods=None, workers=1, *, fixed=(), tied=None,
    log=(), weights=None, prior=None, starts=1, work=None, call_time=None, out="results/fit", name="fit", progress=True,
):
    """Fits x so that forward(x) is close to the data; returns a Fit.

    forward(x) -> y (m): x is an array (k). What it raises is a failed call, except at x0. Or an isoline.command.
    data: m numbers; or the path of a CSV file or a frame of pandas, as read_data() reads them; or a Data.
    x0: the start (k), or a dict from names to numbers.
    sigma: the standard deviation of the data, one or (m), in their units. Where it is given, each datum counts by
        1/σ², and the χ² test decides whether the model explains the data.
    bounds=(lower, upper): numbers or lists (k). names, units: texts (k).
    methods: one of Isoline's optimizers, or a list. The point of least loss is the result. By default,
        Levenberg-Marquardt with forward differences; if its point is not a confirmed minimum, with central ones,
        and so on from points beside the best one, at most six runs in all.
    workers: so many calls at a time, each in a thread of this process; forward must permit it. Programs
        (isoline.command) then run at the same time, functions of pure Python do not.
    fixed: names or numbers of unknowns that stay at x0, or a dict from them to values.
    tied: a dict from names to expressions of other names, such as {"k2": "2 * k1"}.
    log: names of positive unknowns; the method sees their logarithms.
    weights: factors of the residuals, one or (m), in place of sigma: relative precision, of unknown scale.
    prior: a dict from names to (mean, standard deviation) of a normal distribution; requires sigma.
    starts: so many starts: x0, and points of a Latin hypercube over the bounds. Fit.basins has their ends.
    work: the most forward solves of each run. call_time: a call that takes more seconds has failed; it still ends by itself.
    out: the result folder. An interrupted fit goes on if it is repeated: finished runs and calls of 0.1 s
        or more are not made again, as long as forward(x0) and the arguments are the same.

    Raises Refused where arguments are wrong or Isoline refuses them. Ctrl-C raises KeyboardInterrupt after
    Isoline has ended.
    """
    model = _Model(forward, data, x0, sigma, bounds, names, units, fixed, tied, log, weights, prior, progress)
    rows = _starts(model, starts)
    y0 = model.answer(model.x_of(model.z0))
    if not np.all(np.isfinite(y0)):
        raise Refused(f"forward(x0) must be finite, got {y0}")
    sizes, numbers = (len(model.x0), len(y0)), lambda values: isoline._json_numbers(values, "x0")
    is_bounded = bool(np.any(np.isfinite(model.bounds)))

    def description(seed):
        return {
            "name": name, "inputs": sizes[0], "outputs": sizes[1], "oracles": ["forward"], "differences": True,
            "start": numbers(model.inside(rows[0])), "drawn": numbers(model.inside(rows[seed])), "target": numbers(model.data),
            "bounds": [numbers(side) for side in model.bounds] if is_bounded else None, "active_bounds": is_bounded,
            "names": model.names, "units": model.units, "start_scale": "own", "words": model.words,
        }

    bridge = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bridge.py")
    more = (f",workers={workers}" if workers > 1 else "") + (f",call-time={call_time}" if call_time else "")
    words = [_program(), "run", "--seeds", str(starts), "--out", str(out), "--uncertified", "--no-report", "--jobs", "1",
             "--time", "1000000s", *(["--work", str(work)] if work else [])]  # a call may take hours
    records, asked = [], [methods] if isinstance(methods, str) else list(methods or [])
    for attempt in range(1 if asked or starts > 1 else MOST_ATTEMPTS):
        some = asked or [CENTRAL if attempt % 2 else METHOD]
        command = shlex.join([sys.executable or "python3", "-IS", bridge, f"{name}-{model.key([*y0, *rows[0]])}"])
        spec = f"process[command={json.dumps(command, ensure_ascii=False)},label={name}{more}]"
        code, printed = _run([*words, "--problem", spec, "--optimizer", ",".join(some)], workers, description,
                             isoline._Given(model.answer, None, None, None), sizes)
        new = [each for each in _records(out, command, work) if asked or each["request"]["optimizer"]["asked"] in some]
        if not any("answer" in each for each in new):
            why = "; ".join(f"{each['request']['optimizer']['spec']} is {each['status']}: {each['message']}" for each in new)
            raise Refused(why or printed.strip() or f"isoline ended with exit code {code}")
        records += [each for each in new if "answer" in each]
        if any(each["status"] in FITS for each in new):
            break
        if attempt > 0 or any(each.get("failures") for each in records):  # there, the calls of differences are others
            best = min(records, key=lambda each: float(each["summary"]["loss"]))
            beside = model.z_of(best["answer"]["x"][0]) * (1 + 3e-3 * (attempt + 1))
            rows[0] = np.clip(beside, model.lower, model.upper)
    model.show(math.inf, is_last=True)
    return Fit(model, records, str(out))


def _records(out, command, work):
    """Those of this problem and budget, the newest of each method and start."""
    found, folder = {}, os.path.join(out, "runs")
    for each in os.listdir(folder) if os.path.isdir(folder) else []:
        with open(os.path.join(folder, each), encoding="utf-8") as file:
            record = json.load(file)
        request = record["request"]
        if request["problem"]["options"].get("command") == command and request["budget"]["work"] == work:
            cell, begun = (request["optimizer"]["spec"], request["seed"]), record["provenance"]["run"]["started"]
            found[cell] = max(found.get(cell, ("", None)), (begun, record), key=lambda pair: pair[0])
    return [record for _, record in found.values()]


# --- statistics


def t_quantile(degrees):
    """The t with P(|T| ≤ t) = 0.95, of Student's distribution: T = √ν tan θ, where θ has the density cos^(ν−1)."""
    angle = np.linspace(0, min(math.pi / 2, 40 / math.sqrt(degrees)), 100_001)  # beyond 40, the density vanishes
    density = np.cos(angle) ** (degrees - 1)
    total = np.cumsum(density[1:] + density[:-1])
    return math.sqrt(degrees) * math.tan(np.interp(LEVEL * total[-1], total, angle[1:]))


def chi_square_tail(value, degrees):
    """P(χ² ≥ value), with an integer number of degrees of freedom; Abramowitz, Stegun (1964), 26.4.4 and 26.4.5."""
    half, odd = max(value, 1e-300) / 2, degrees % 2
    powers = [k + odd / 2 for k in range(degrees // 2)]
    total = sum(math.exp(power * math.log(half) - half - math.lgamma(power + 1)) for power in powers)
    return min(1.0, total + (math.erfc(math.sqrt(half)) if odd else 0.0))


class Fit:
    """The result of fit(). Arrays are NumPy's; k is the number of names, m that of data.

    x (k): the fitted values, in `units` of `names`.
    sd (k): standard deviations by (JᵀJ)⁻¹ s²; NaN for fixed unknowns and those at an active bound, which are held.
    interval (k, 2): x ± t·sd, 95 %, t with `degrees_of_freedom`; of log= unknowns, symmetric in the logarithm.
    correlation (k, k): NaN where sd is.
        sd, interval and correlation are None where the point is not a fit; `message` says why.
    loss: ½ Σ ((y - data)/σ)², with σ = 1/weight where it is unknown, and ½ ((x - mean)/sd)² for each prior.
    p: of the χ² test; None without sigma.
    calls: of forward that this process made. work: forward solves of the best run, as its record counts them.
    status, method: of the run of least loss. message: what one should know; may be empty.
    y (m): forward(x); NaN if this call fails. residuals (m): y - data.
    runs: a (method, start, status, loss, x) for each run. basins: a (runs, loss, x) for each minimum found.
    out: the result folder, for `isoline report`.
    """

    def __init__(self, model, records, out):
        self._model, self.names, self.units, self.out = model, model.names, model.units, out
        ends = [(record, float(record["summary"]["loss"]), model.z_of(record["answer"]["x"][0])) for record in records]
        ends.sort(key=lambda end: (not math.isfinite(end[1]), end[1]))
        self.runs = [(record["request"]["optimizer"]["spec"], record["request"]["seed"], record["status"], loss, model.x_of(z))
                     for record, loss, z in ends]
        near = (1 + 1e-5) * ends[0][1]  # of losses that differ by noise, that of an examined point
        self._record, self.loss, self._z = next((end for end in ends if end[1] <= near and end[0]["status"] in FITS), ends[0])
        self.x, self.status, self.work = model.x_of(self._z), self._record["status"], self._record["summary"]["work"]
        self.method = self._record["request"]["optimizer"]["spec"]
        try:
            self.y = model.y(self.x)
        except Exception:
            self.y = np.full(len(model.data), math.nan)
        self.residuals = self.y - model.data
        margin = np.where(model.is_log, 1e-12, 0)  # of a logarithm, in units of the records
        self._held = (self._z <= model.lower + margin) | (self._z >= model.upper - margin)
        self._z = np.clip(self._z, model.lower, model.upper)
        self.degrees_of_freedom = len(model.target) - int(np.sum(~self._held))
        self.sd = self.interval = self.correlation = self._covariance = self.p = self._profile = None
        why, messages = self._why_not(), []
        if why:
            messages.append(f"no uncertainty: {why}")
        else:
            self._uncertainty()
        if np.any(self._held):
            messages.append("held at a bound: " + ", ".join(np.array(self.names)[model.free][self._held]))
        self.message = "; ".join(filter(None, [*messages, self._record["message"]]))
        nothing = 1e-10 * np.nanmax([float(record["summary"]["start_loss"]) for record, *_ in ends])  # zero residuals
        self.basins, self.calls = self._basins(nothing), model.calls

    def _why_not(self):
        """Why the point has no uncertainty; empty if it has one. Sets p."""
        if self.status not in FITS:
            return f"the status of the best run is {self.status}, so its point is not a confirmed minimum"
        if self.degrees_of_freedom < 1:
            return "there are not more data than unknowns"
        if 2 * self.loss <= 1e-20 * np.sum(self._model.target**2):  # as of rounding
            return "the residuals vanish, so they do not show how noisy the data are"
        if self._model.sigma is not None:
            self.p = chi_square_tail(2 * self.loss, self.degrees_of_freedom)
            if self.p < LEAST_P:
                value = f"χ² = {2 * self.loss:.4g}, {self.degrees_of_freedom} degrees of freedom, p = {self.p:.1g}"
                return f"the residuals contradict sigma ({value})"
        known, s2 = self._record.get("uncertainty"), 2 * self.loss / self.degrees_of_freedom
        if known:
            free = self._model.free  # what a bound holds has no deviation
            size = np.where(self._model.is_log, self.x[free], 1.0)  # ∂x/∂z
            deviation = np.nan_to_num(np.array(known["standard_deviation"], float)[free]) / size
            correlation = np.nan_to_num(np.array(known["correlation"], float)[np.ix_(free, free)])
            self._unheld = correlation * np.outer(deviation, deviation) * s2 / float(known["variance"])
        else:  # a call of Isoline's differences may have failed
            self._unheld = self._computed(s2)
        return "" if self._unheld is not None else "some unknowns, or a combination of them, have no effect on y"

    def _computed(self, s2):
        """(JᵀJ)⁻¹ s² (n, n) by differences, with no unknown held; None where J does not have full rank."""
        model, r = self._model, self._model.residual(self._z)
        steps = 1e-3 * np.maximum(np.maximum(abs(self._z), abs(model.z0)), 1e-12)
        for _ in range(2 if r is not None else 0):  # the second steps change r by 0.3 s
            J = np.array([model.column(self._z, j, step, r) for j, step in enumerate(steps)]).T
            sizes = np.linalg.norm(J, axis=0)
            if not np.all(sizes > 0):
                return None
            steps = 0.3 * math.sqrt(s2) / sizes
        if r is None or np.linalg.cond(J / sizes) > 1e7:
            return None
        return np.linalg.inv((J / sizes).T @ (J / sizes)) * s2 / np.outer(sizes, sizes)

    def _uncertainty(self):
        """sd, interval and correlation of x, from the covariance of z. To hold an unknown is to condition on its value."""
        model, c, count = self._model, self._unheld.copy(), len(self.names)
        for j in np.flatnonzero(self._held):
            c -= np.outer(c[:, j], c[j]) / c[j, j] if c[j, j] > 0 else 0
            c[j], c[:, j] = 0, 0
        self._covariance = c
        slopes = np.zeros((count, len(c)))  # ∂x/∂z by central differences, exact where x is z
        for j, h in enumerate(1e-3 * np.sqrt(np.diag(c))):
            if h > 0:
                shift = h * (np.arange(len(c)) == j)
                slopes[:, j] = (model.x_of(self._z + shift) - model.x_of(self._z - shift)) / (2 * h)
        c = slopes @ c @ slopes.T
        self.sd = np.sqrt(np.where(np.diag(c) > 0, np.diag(c), math.nan))
        half, logs = t_quantile(self.degrees_of_freedom) * self.sd, np.isin(range(count), np.array(model.free)[model.is_log])
        ratio = np.exp(np.where(logs, half / self.x, 0))
        low, high = np.where(logs, self.x / ratio, self.x - half), np.where(logs, self.x * ratio, self.x + half)
        self.interval = np.array([low, high]).T
        self.correlation = c / np.outer(self.sd, self.sd)

    def _basins(self, nothing):
        """Ends whose losses agree to 1e-4, or by the loss `nothing`, and whose unknowns agree to 1e-2 are one minimum."""
        found, size = [], 1e-9 * max(abs(self._model.x0))
        for *_, loss, x in self.runs:
            same = [each for each in found if abs(loss - each[1]) <= 1e-4 * each[1] + nothing and np.allclose(x, each[2], 1e-2, size)]
            found += [] if same else [[0, loss, x]]
            (same or found[-1:])[0][0] += 1
        return [tuple(basin) for basin in found]

    def profile(self, names=None):
        """Profile-likelihood intervals: a Profile. Each value of an unknown is tried with all others fitted again.

        A value belongs to the interval if S ≤ S_min (1 + t²/ν), as of lmfit's conf_interval. Prints how many
        calls of forward to expect. names: of these unknowns only. Raises Refused where the point is not a fit.
        """
        if self._covariance is None:
            raise Refused(f"a profile requires a fit, but there is {self.message}")
        self._profile = Profile(self, [j for j, i in enumerate(self._model.free) if names is None or self.names[i] in names])
        self._profile.keep(os.path.join(self.out, "profile.json"), self._record["cell"])
        return self._profile

    def _rows(self):
        """The head, and the parameters, as text."""
        rows = [["name", "unit", "x", f"± t·sd (95 %, ν = {self.degrees_of_freedom})", "sd", "interval"]]
        held = np.array(self._model.free)[self._held]
        for i, name in enumerate(self.names):
            row = ["fixed" if i in self._model.fixed else "at its bound" if i in held else "", "", ""]
            if self.sd is not None and self.sd[i] > 0:
                half, (low, high) = t_quantile(self.degrees_of_freedom) * self.sd[i], self.interval[i]
                row = [f"{half:.2g}", f"{self.sd[i]:.2g}", f"{low:.5g} … {high:.5g}"]
            rows.append([name, self.units[i], f"{self.x[i]:.7g}", *row])
        return rows

    def _summary(self):
        test = "" if self.p is None else f", χ² test p = {self.p:.2g}"
        lines = [f"{self.method}: {self.status}, loss {self.loss:.6g}, {self.work} forward solves{test}", self.message]
        if len(self.runs) > 1:
            lines += [f"{count} of {len(self.runs)} runs ended at loss {loss:.6g}, x = {', '.join(f'{each:.6g}' for each in x)}"
                      for count, loss, x in self.basins]
        return list(filter(None, lines))

    def table(self):
        """The parameters with intervals, and their correlations above 0.5, as text."""
        lines, count = self._summary() + _text_table(self._rows()), len(self.names)
        for i, j in ((i, j) for i in range(count if self.sd is not None else 0) for j in range(i)):
            if abs(self.correlation[i][j]) > 0.5:
                lines.append(f"correlation of {self.names[j]} and {self.names[i]}: {self.correlation[i][j]:.3f}")
        return "\n".join(lines)

    __repr__ = table

    def _repr_html_(self):
        model, parts = self._model, [f"<p>{html.escape(line)}</p>" for line in self._summary()] + [_html_table(self._rows())]
        if self.correlation is not None:
            cells = [["" if each != each else f"{each:.2f}" for each in row] for row in self.correlation]
            rows = [[name, *row] for name, row in zip(self.names, cells)]
            parts.append(_html_table([["correlation", *self.names], *rows]))
        if self._profile:
            parts.append(_html_table(self._profile.rows()))
        try:
            from matplotlib.figure import Figure
        except ImportError:
            return "".join(parts)
        label = model.table.x if model.table and model.table.x else "number of the datum"
        place = model.table[label] if model.table and model.table.x else np.arange(len(model.data))
        figure, curve, text = Figure((12, 3.2), layout="constrained"), self._record["curve"], io.StringIO()
        fit, residuals, loss = figure.subplots(1, 3)
        fit.errorbar(place, model.data, model.sigma, fmt="k.")
        fit.plot(*np.array(sorted(zip(place, self.y))).T)
        residuals.errorbar(place, self.residuals, model.sigma, fmt="k.")
        residuals.axhline(0)
        loss.semilogy(*np.array([curve["work"], curve["loss"]], float))
        fit.set(xlabel=label, ylabel="data and fit")
        residuals.set(xlabel=label, ylabel="residuals y − data")
        loss.set(xlabel="forward solves", ylabel="loss")
        figure.savefig(text, format="svg")
        return "".join(parts) + text.getvalue()[text.getvalue().index("<svg"):]


def _text_table(rows):
    widths = [max(map(len, column)) for column in zip(*rows)]
    return ["  ".join(word.rjust(width) for word, width in zip(row, widths)).rstrip() for row in rows]


def _html_table(rows):
    lines = ["".join(f"<td>{html.escape(word)}</td>" for word in row) for row in rows]
    return f"<table>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


class Profile:
    """Profile-likelihood intervals of a Fit, and the points by which they were found.

    names: of the profiled unknowns. interval: an array (len(names), 2); ±infinity where the profile stays flat.
    points: by name, the (value, S/S_min) tried. messages: what limits an interval. calls: of forward.

    The others are fitted by Levenberg-Marquardt steps, whose J begins with central differences at the fit and
    follows by Broyden's formula (1965); where it does not predict r, and at each end, differences replace it.
    """

    MOST_POINTS = 20  # on each side
    TOLERANCE = 0.005  # of t, at which a point counts as the end of the interval

    def __init__(self, fit, wanted):
        self._fit, self._model, model, count = fit, fit._model, fit._model, len(fit._z)
        self.names, self.messages, began = [fit.names[model.free[j]] for j in wanted], [], model.calls
        self.points = {name: [] for name in self.names}
        expected = 1 + 2 * count + 8 * len(wanted) * (5 if count > 1 else 1)  # measured on ten calibrations
        print(f"profile: about {expected} calls of forward, more if it is strongly nonlinear", file=sys.stderr, flush=True)
        self._t, self._origin = t_quantile(fit.degrees_of_freedom), model.residual(fit._z)
        if self._origin is None:
            raise Refused("forward failed at the fit, where it had a value before")
        self._least = self._origin @ self._origin
        self._s2 = self._least / fit.degrees_of_freedom
        # differences: 0.3 of the standard deviation of an unknown if all others are known
        size = np.maximum(abs(fit._z), abs(model.z0))
        self._steps, free = 1e-3 * np.where(size > 0, size, 1.0), ~fit._held
        deviation = np.sqrt(np.diag(fit._covariance)[free])
        inverse = np.linalg.inv(fit._covariance[np.ix_(free, free)] / np.outer(deviation, deviation))
        self._steps[free] = 0.3 * deviation / np.sqrt(np.diag(inverse))
        self._J = np.array([model.column(fit._z, j, self._steps[j], self._origin) for j in range(count)]).T
        ends = [[model.outer(j, self._end(j, sign)) for sign in (-1, 1)] for j in wanted]
        self.interval, self.calls = np.array(ends), model.calls - began
        model.show(math.inf, is_last=True)

    def keep(self, path, cell):
        """Puts it where `isoline report` finds it, in place of an earlier one of the cell."""
        try:
            with open(path, encoding="utf-8") as file:
                cells = [each for each in json.load(file)["cells"] if each["cell"] != cell]
        except (OSError, ValueError, KeyError):
            cells = []
        profiles = []
        for name, (low, high) in zip(self.names, self.interval):
            least = (self._fit.x[self._fit.names.index(name)], 1.0)
            values, rises = zip(*sorted({least, *self.points[name]}))
            low, high, *numbers = isoline._json_numbers([low, high, *values, *((each - 1) * self._least / self._s2 for each in rises)], name)
            profiles.append({"unknown": name, "low": low, "high": high, "value": numbers[: len(values)], "rise": numbers[len(values):],
                             "messages": [each for each in self.messages if name in each.split()]})
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"schema": "isoline.profile/1", "cells": [*cells, {"cell": cell, "profiles": profiles}]}, file)

    def _u(self, r):
        """√((S − S_min)/s²), nearly linear in the distance of the profiled unknown from the fit."""
        return math.sqrt(max(r @ r - self._least, 0) / self._s2)

    def _end(self, j, sign):
        """z_j at the end of its interval on one side."""
        fit, t, name = self._fit, self._t, self._fit.names[self._model.free[j]]
        room = abs((self._model.upper if sign > 0 else self._model.lower)[j] - fit._z[j])
        size = max(abs(fit._z[j]), abs(self._model.z0[j]))
        reach = t * math.sqrt(fit._unheld[j, j]) or 0.1 * size or 1.0
        known = [(0.0, 0.0, fit._z, self._origin)]  # distance, u, z and r; by distance
        failed, is_hard, J = math.inf, False, self._J.copy()  # failed: the least distance at which forward fails
        distance = reach if reach < room else room / 2
        for _ in range(self.MOST_POINTS if room else 0):
            z = self._predicted(known, j, sign, distance)
            value = self._model.outer(j, z[j])
            found = self._refitted(z, j, J, min(known, key=lambda each: abs(each[0] - distance)))
            if found is None:
                self.messages.append(f"forward fails at {name} = {value:.6g}")
                failed = min(failed, distance)
            elif not found[2]:  # with a start nearer to its end, it may converge
                is_hard, distance = True, (max(d for d, *_ in known if d < distance) + distance) / 2
                continue
            else:
                z, r, _ = found
                self.points[name].append((value, r @ r / self._least))
                if r @ r < self._least * (1 - 1e-6):
                    better = ", ".join(f"{each:.8g}" for each in self._model.x_of(z))
                    self.messages.append(f"{name} = {value:.6g} has a lower loss, {r @ r / 2:.6g}: fit again from x0 = {better}")
                known = sorted([*known, (distance, self._u(r), z, r)], key=lambda each: each[0])
                known = known[:1] + [b for a, b in zip(known, known[1:])  # a jump: the farther fit ended in another minimum
                                     if b[1] - a[1] <= 0.3 * t or b[0] - a[0] >= 0.1 * b[0]]
                if abs(self._u(r) - t) <= self.TOLERANCE * t or distance == room and self._u(r) < t:
                    break
            distance = self._next(known, failed, reach, room)
            if distance is None or any(d == distance for d, *_ in known):
                break
        if any(u >= t * (1 - self.TOLERANCE) for _, u, *_ in known):
            if min(abs(u - t) for _, u, *_ in known) > 0.02 * t:
                self.messages.append(f"a limit of {name} is inexact: {self.MOST_POINTS} points did not find it")
            end = min(self._crossing(known), room)
            z = min(known, key=lambda each: abs(each[0] - end))[2]
            bounded = ((z <= self._model.lower) | (z >= self._model.upper)) & ~fit._held
            if held := [fit.names[self._model.free[i]] for i in np.flatnonzero(bounded) if i != j]:
                side = "upper" if sign > 0 else "lower"
                self.messages.append(f"the {side} limit of {name} holds with {', '.join(held)} at a bound; without it, it lies beyond")
            return fit._z[j] + sign * end
        last, side = known[-1][0], "upper" if sign > 0 else "lower"
        value = self._model.outer(j, fit._z[j] + sign * last)
        end = fit._z[j] + sign * last
        why = f"the {side} limit of {name} lies where forward fails; {value:.6g} is the last value before"
        if is_hard:
            why = f"the {side} limit of {name} was not found: fits of the others beyond {value:.6g} do not converge"
            end = math.nan
        elif last >= room:
            why = f"{name} has no {side} limit within its bounds: the interval is one-sided"
        elif failed == math.inf:
            why = f"{name} is not identifiable {'above' if sign > 0 else 'below'} {value:.6g}: the profile is flat"
            end = sign * math.inf
        self.messages.append(why)
        return end

    def _predicted(self, known, j, sign, distance):
        """A first z at a distance: by the covariance from the fit, or along the line through the nearest two points."""
        (d0, _, z0, _), *near = sorted(known, key=lambda each: abs(each[0] - distance))[:2]
        c = self._fit._covariance if self._fit._covariance[j, j] > 0 else self._fit._unheld
        slope = sign * c[j] / c[j, j] if c[j, j] > 0 else np.zeros(len(z0))
        for d1, _, z1, _ in near:
            slope = (z1 - z0) / (d1 - d0)
        z = z0 + slope * (distance - d0)
        z[j] = self._fit._z[j] + sign * distance
        return np.clip(z, self._model.lower, self._model.upper)

    def _next(self, known, failed, reach, room):
        """The next distance to try; None if there is none."""
        last = known[-1][0]
        if any(u >= self._t for _, u, *_ in known):
            return self._crossing(known, margin=0.1)
        if failed < math.inf:
            return (last + failed) / 2 if failed - last > 0.02 * failed else None
        most = (1.3 if known[-1][1] > 0.8 * self._t else 2.5) * last or reach / 2
        return None if last > 100 * reach else min(self._crossing(known), most, room)  # None: flat

    def _crossing(self, known, margin=0.0):
        """The distance at which u = t, by a parabola or a line through the nearest points.

        Where they are far from t, it keeps a margin to both ends, as a share of what is between them.
        """
        t = self._t
        points = sorted({u: d for d, u, *_ in known}.items(), key=lambda each: abs(each[0] - t))[:3]
        low = max(d for d, u, *_ in known if u <= t)
        high = min((d for d, u, *_ in known if u >= t and d >= low), default=math.inf)
        margin *= high - low if high < math.inf and abs(points[0][0] - t) > 0.2 * t else 0.0
        for some in (points, points[:2]):  # d as a polynomial of u: Lagrange's formula
            d = sum(d * math.prod((t - v) / (u - v) for v, _ in some if v != u) for u, d in some)
            if len(some) > 1 and low <= d <= high:
                return min(max(d, low + margin), high - margin)
        return (low + high) / 2 if high < math.inf else 2.5 * low

    def _refitted(self, z, fixed, J, nearest):
        """z with all but one unknown fitted again, r there, and whether this converged. Changes J.

        None where forward fails.
        """
        model, others = self._model, [i for i in range(len(z)) if i != fixed]
        for shift in (0, 1, -1, 2):  # a call may fail here and not nearby
            first = np.clip(z + shift * self._steps, model.lower, model.upper)
            first[fixed] = z[fixed]
            r = model.residual(first)
            if r is not None:
                break
        else:
            return None
        z, damping, enough, rejected, is_fresh = first, 1e-6, 5e-3 * self._s2, 0, False
        is_trusted = self._updated(J.copy(), nearest[2], nearest[3], z, r)  # whether J predicts r
        for _ in range(50):
            step, promised = self._step(z, r, others, J, damping)
            is_end = abs(self._u(r) - self._t) <= self.TOLERANCE * self._t  # to be sure of
            is_near = promised <= 10 * enough
            if promised <= enough and (is_fresh or is_trusted and not is_end) or rejected > (3 if is_near else 12):
                return z, r, is_near
            if not is_fresh and (promised <= enough or not is_trusted and rejected != 1):
                J[:, others] = np.array([model.column(z, i, self._steps[i], r) for i in others]).reshape(-1, len(r)).T
                is_fresh, damping = True, min(damping, 1e-3)
                continue
            trial = np.clip(z + step, model.lower, model.upper)
            there = model.residual(trial)
            is_better = there is not None and there @ there < r @ r
            is_trusted = there is not None and self._updated(J if is_better or not is_fresh else J.copy(), z, r, trial, there)
            if is_better:
                z, r, rejected, damping, is_fresh = trial, there, 0, damping / 5, False
            else:
                rejected, damping = rejected + 1, max(10 * damping, 1e-3)
        return z, r, False

    def _updated(self, J, z, r, to, there):
        """J after a step by Broyden's formula, in units of the differences; whether J predicted it to a third."""
        moved, change = (to - z) / self._steps, there - r
        miss = change - J @ (to - z)
        J += np.outer(miss, moved / self._steps) / (moved @ moved or 1)
        return miss @ miss <= change @ change / 9

    def _step(self, z, r, others, J, damping):
        """The Levenberg-Marquardt step over the unknowns that no bound holds, and the decrease of S without damping."""
        gradient, size, step = J.T @ r, np.linalg.norm(J, axis=0), np.zeros(len(z))
        pushed = (z <= self._model.lower) & (gradient > 0) | (z >= self._model.upper) & (gradient < 0)
        free = [i for i in others if size[i] > 0 and not pushed[i]]
        A, b = J[:, free] / size[free], -gradient[free] / size[free]
        undamped, step[free] = (np.linalg.solve(A.T @ A + d * np.eye(len(free)), b) for d in (1e-12, damping))
        step[free] /= size[free]
        return step, undamped @ b

    def rows(self):
        ends = [[name, f"{low:.5g} … {high:.5g}"] for name, (low, high) in zip(self.names, self.interval)]
        return [["name", "profile interval (95 %)"], *ends]

    def table(self):
        return "\n".join(_text_table(self.rows()) + self.messages)

    __repr__ = table
