"""isoline.fit: parameters of a function, with uncertainties, from data. Requires NumPy, which read_data does not.

The program `isoline` looks for the parameters, and computes their uncertainties and profiles. It starts bridge.py,
which passes its socket on to this process, so `forward` may be any function, such as a closure in a notebook.

Notation: x (k) are the unknowns, y = forward(x) (m); r = ((y - data)/σ, (x - mean)/sd of priors); S = ‖r‖² = 2 L; ν is
the length of r minus the number of unknowns that are neither fixed, tied nor held by a bound; s² = S/ν.
"""

import csv
import hashlib
import html
import inspect
import io
import itertools
import json
import math
import os
import re
import select
import shlex
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time

import isoline
from isoline import Refused

np = isoline.numpy  # None where it is not installed

METHOD, CENTRAL = "levenberg-marquardt[jacobian=differences]", "levenberg-marquardt[jacobian=central]"
MOST_ATTEMPTS = 6  # of the default methods, until a point is a confirmed minimum
FITS = ("converged", "target", "discrepancy")  # statuses of a point that Isoline has examined


# --- data


class Data:
    """Columns by name, data["t"] (m), of which y (m) is fitted. sigma (m) or None; x: the name of another column, or None.

    Columns are arrays, or lists where NumPy is not installed.
    """

    def __init__(self, columns, y, sigma):
        self.columns, self.y, self.y_name, self.sigma = columns, columns[y], y, columns.get(sigma)
        self.x = next((name for name in columns if name not in (y, sigma)), None)

    def __getitem__(self, name):
        return self.columns[name]


def read_data(source, y="y", sigma="sigma"):
    """Data from a CSV file with a header (a path), below lines that begin with #, or from a frame of pandas.

    y: the column of measured values. sigma: that of their standard deviations, in units of y, if there is one.
    Raises Refused, with the line, for a missing value, and for a word that is not a number, in any column.
    """
    is_file = isinstance(source, (str, os.PathLike))
    rows = _rows_of_file(source) if is_file else _rows_of_frame(source)
    names = next(rows)
    if names.count(y) != 1 or len(set(names)) < len(names):
        raise Refused(f"{source if is_file else 'the data'} must have one column {y!r} and no name twice, "
                      f"got {', '.join(names)[:200]}; y= sets another name")
    columns = {name: [] for name in names}
    for place, row in rows:
        if len(row) != len(names):
            raise Refused(f"{place}: expected {len(names)} fields, as in the header, found {len(row)}")
        for name, word in zip(names, row):
            columns[name].append(_datum(word, f"{place}, column {name}"))
    return Data({name: np.array(column, float) for name, column in columns.items()} if np else columns, y, sigma)


def _rows_of_file(path):
    with open(path, newline="", encoding="utf-8-sig", errors="replace") as file:
        above, header = 0, file.readline()
        while header.startswith("#"):
            above, header = above + 1, file.readline()
        mark = next((mark for mark in ";\t" if mark in header), ",")
        reader = csv.reader(itertools.chain([header], file), delimiter=mark)
        try:
            yield [name.strip() for name in next(reader)]
            yield from ((f"{path}, line {above + reader.line_num}", row) for row in reader if row)
        except csv.Error:
            raise Refused(f"{path}, line {above + reader.line_num}: expected fields of at most {csv.field_size_limit()} characters, "
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
    """The problem as Isoline is given it: answers its calls, counts them, and shows progress."""

    def __init__(self, forward, data, x0, sigma, bounds, names, units, fixed, tied, log, weights, prior, starts, progress):
        if isinstance(data, (str, os.PathLike)) or hasattr(data, "itertuples"):
            data = read_data(data)
        self.table = data if isinstance(data, Data) else None
        if self.table:
            data, sigma = data.y, data.sigma if sigma is None else sigma
        if isinstance(x0, dict):
            names, x0 = list(x0), list(x0.values())
        self.forward, self.progress = forward, progress
        self.data = np.array([_datum(each, f"data[{i}]") for i, each in enumerate(isoline._column(data, "data"))])
        x0 = isoline._column(x0, "x0").copy()
        count = len(x0)
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
            x0[self.index(which)] = value
        self.prior = {self.index(which): (float(mean), float(sd)) for which, (mean, sd) in (prior or {}).items()}
        if self.prior and self.sigma is None:
            raise Refused("prior requires sigma: without it, the weight of the data beside the prior is unknown")
        self.fixed, tied = {self.index(which) for which in fixed}, tied or {}
        self.free = [i for i in range(count) if i not in self.fixed | {self.index(which) for which in tied}]
        lower, upper = (_spread(side, count, "bounds") for side in bounds or (-math.inf, math.inf))
        for i in [*self.free, *self.fixed]:
            if not lower[i] <= x0[i] <= upper[i] or i in map(self.index, log) and not x0[i] > 0:
                limits = f"its bounds {lower[i]:g} and {upper[i]:g}"
                raise Refused(f"x0 of {self.names[i]} is {x0[i]:g}; it must lie in {limits}, and be positive for log=")
        self.bounds = lower, upper
        for which, words in tied.items():
            known = {**vars(math), "abs": abs, **{f"_{i}": value for i, value in enumerate(x0)}}
            named = lambda found: f"_{self.names.index(found[0])}" if found[0] in self.names else found[0]
            try:  # a name may be a word of Python
                text = re.sub(r"(?<![\w.])[^\W\d]\w*", named, words.replace("^", "**"))
                x0[self.index(which)] = eval(text, {"__builtins__": {}}, known)
            except (NameError, SyntaxError) as error:
                raise Refused(f"{which} is tied to {words!r}, which cannot be computed: {error}") from None
        self.tied = {self.index(which) for which in tied}
        self.x0, self.begin = x0, x0  # (k), and those of the next run
        axis = self.table and isoline._axis(self.table)
        many = starts if starts > 1 else None
        self.words = isoline._words(self.names, count, fixed, tied, log, sigma, weights, prior, many, axis=axis)
        self.calls, self.least, self.shown, self.lock = 0, math.inf, time.monotonic(), threading.Lock()

    def index(self, which):
        if which not in self.names and which not in range(len(self.names)):
            raise Refused(f"there is no unknown {which!r}; there are {', '.join(self.names)}")
        return self.names.index(which) if which in self.names else which

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
        r = np.append((y - self.data) * self.factor, [(x[i] - mean) / sd for i, (mean, sd) in self.prior.items()])
        self.show(r @ r / 2)
        return y

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
        arrays = [list(each) for each in (y0, self.data, np.atleast_1d(self.factor), self.x0, *self.bounds)]
        return hashlib.sha1(repr([*arrays, self.names, self.units, self.words, text]).encode()).hexdigest()[:12]

    def description(self, name, drawn):
        """`drawn` (k) or None: where a run begins in place of x0."""
        numbers, start = lambda values: isoline._json_numbers(values, "x0"), self.x0
        is_bounded = bool(np.any(np.isfinite(self.bounds)))
        return {
            "name": name, "inputs": len(start), "outputs": len(self.data), "oracles": ["forward"], "differences": True,
            "start": numbers(start), "drawn": None if drawn is None else numbers(drawn), "target": numbers(self.data),
            "bounds": [*map(numbers, self.bounds)] if is_bounded else None,
            "active_bounds": is_bounded, "names": self.names, "units": self.units, "start_scale": "own", "words": self.words,
        }


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

    def __init__(self, bridge, descriptor, model, description):
        self.bridge, self.line, self.points = bridge, isoline._Line(descriptor), {}
        self.description, self.products = description, isoline._Given(model.answer, None, None, None)
        self.sizes = description["inputs"], description["outputs"]

    def step(self):
        """Answers one request; False after the last one."""
        try:
            if self.description:
                greeting = json.loads(bytes(self.line.receive()[2]))
                isoline._introduce(self.line, greeting, "problem", self.description)
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


def _run(words, workers, model, description, out=None):
    """Runs Isoline, and answers its evaluations. Returns the exit code and what it printed; with `out`, the JSON of that file."""
    isoline._remove_abandoned()
    folder = tempfile.mkdtemp(prefix=f"{isoline._folder_prefix()}{os.getpid()}-")  # no other user can connect
    path, open_lines, printed = os.path.join(folder, "socket"), {}, b""
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(path)
        listener.listen()
        program = subprocess.Popen(
            [_program(), *words, *(["--out", os.path.join(folder, out)] if out else [])], env=dict(os.environ, ISOLINE_FIT=path),
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True,
        )
        try:
            while True:
                for ready in select.select([listener, program.stdout, *open_lines], [], [])[0]:
                    if ready is program.stdout:
                        more = os.read(ready.fileno(), 1 << 16)
                        printed = (printed + more)[-(1 << 16):]
                        if out and more.startswith(b"profile:"):
                            print(more.decode(errors="replace"), end="", file=sys.stderr, flush=True)
                        if more:
                            continue
                        code, said = program.wait(), printed.decode(errors="replace").strip()
                        if not out:
                            return code, said
                        if not os.path.exists(os.path.join(folder, out)):
                            raise Refused(said)
                        with open(os.path.join(folder, out), encoding="utf-8") as file:
                            return json.load(file)
                    elif ready is listener:
                        bridge, _ = listener.accept()
                        _, descriptors, *_ = socket.recv_fds(bridge, 1, 1)
                        if not descriptors:  # Isoline has ended it
                            bridge.close()
                            continue
                        one = _Conversation(bridge, descriptors[0], model, description)
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
        and so on from points beside the best one, at most six runs in all; three that end at one loss for one
        reason, such as an unknown without effect, are enough.
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
        or more are not made again, as long as forward gives the same at x0 and at the result, and the arguments
        are the same.

    Raises Refused where arguments are wrong or Isoline refuses them. Ctrl-C raises KeyboardInterrupt after
    Isoline has ended.
    """
    if np is None:
        sys.exit(f"isoline.fit requires NumPy, which {sys.executable} does not have: `python3 -m pip install numpy`, or on "
                 "Debian /usr/bin/python3 and `apt-get install python3-numpy`; isoline.problem works without it")
    model = _Model(forward, data, x0, sigma, bounds, names, units, fixed, tied, log, weights, prior, starts, progress)
    subprocess.run([_program(), "version"], stdout=subprocess.DEVNULL, check=False)  # may build it first, and says so
    y0 = model.answer(model.x0)
    if not np.all(np.isfinite(y0)):
        raise Refused(f"forward(x0) must be finite, got {y0}")
    bridge = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bridge.py")
    more = (f",workers={workers}" if workers > 1 else "") + (f",call-time={call_time}" if call_time else "")
    words = ["run", "--out", str(out), "--uncertified", "--no-report", "--jobs", "1",
             "--time", "1000000s", *(["--work", str(work)] if work else [])]  # a call may take hours
    records, asked = [], [methods] if isinstance(methods, str) else list(methods or [])
    command = shlex.join([sys.executable or "python3", "-IS", bridge, f"{name}-{model.key(y0)}"])
    spec = f"process[command={json.dumps(command, ensure_ascii=False)},label={name}{more}]"
    for attempt in range(1 if asked or starts > 1 else MOST_ATTEMPTS):
        some, described = asked or [CENTRAL if attempt % 2 else METHOD], model.description(name, model.begin if attempt else None)
        begun = ["--starts", f"={attempt}" if attempt else str(starts)]
        code, printed = _run([*words, *begun, "--problem", spec, "--optimizer", ",".join(some)], workers, model, described)
        new = [each for each in _of_methods(_records(out, command, work), some)
               if attempt <= each["request"]["seed"] % 1000 < attempt + starts]
        if not any("answer" in each for each in new):
            why = "; ".join(dict.fromkeys(  # of many starts, one
                f"{each['request']['optimizer']['spec']} is {each['status']}: {each['message']}" for each in new))
            raise Refused(why or printed or f"isoline ended with exit code {code}")
        records += [(each, described) for each in new if "answer" in each]
        ends = [(each["message"], "%.6g" % float(each["summary"]["loss"])) for each, _ in records]
        if any(each["status"] in FITS for each in new) or (attempt > 1 and ends.count(ends[-1]) > attempt):  # other starts end there
            break
        if attempt > 0 or any(each.get("failures") for each, _ in records):  # there, the calls of differences are others
            best = min((each for each, _ in records), key=lambda each: float(each["summary"]["loss"]))
            beside = np.array(best["answer"]["x"][0], float)
            beside[model.free] *= 1 + 3e-3 * (attempt + 1)
            model.begin = np.clip(beside, *model.bounds)
    model.show(math.inf, is_last=True)
    if progress:
        print(f"`isoline report {shlex.quote(str(out))}` makes a page of this fit", file=sys.stderr)
    return Fit(model, records, str(out), workers)


def _of_methods(records, texts):
    """Those of the methods that texts such as "gd,adam[rate=0.1,beta1=0.8]" name: with these options, or else any."""
    specs, depth = [""], 0
    for letter in ",".join(texts).replace(" ", ""):
        depth += (letter == "[") - (letter == "]")
        specs = [*specs, ""] if letter == "," and depth == 0 else [*specs[:-1], specs[-1] + letter]
    all_asked, name_of = [each["request"]["optimizer"]["asked"] for each in records], lambda spec: spec.partition("[")[0]
    named = [name_of(spec) for spec in specs if spec not in all_asked]
    is_set = any(spec.startswith("@") for spec in specs)
    return [each for each, asked in zip(records, all_asked) if is_set or asked in specs or name_of(asked) in named]


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
    y (m): forward(x). residuals (m): y - data.
    runs: a (method, start, status, loss, x) for each run. basins: a (runs, loss, x) for each minimum found.
    out: the result folder, for `isoline report`.
    """

    def __init__(self, model, records, out, workers):
        self._model, self._workers, self.names, self.units, self.out = model, workers, model.names, model.units, out
        ends = [(record, float(record["summary"]["loss"]), np.array(record["answer"]["x"][0], float), described)
                for record, described in records]
        ends.sort(key=lambda end: (not math.isfinite(end[1]), end[1]))
        self.runs = [(record["request"]["optimizer"]["spec"], record["request"]["seed"] % 1000, record["status"], loss, x)
                     for record, loss, x, _ in ends]
        near = (1 + 1e-5) * ends[0][1]  # of losses that differ by noise, that of an examined point
        best = next((end for end in ends if end[1] <= near and end[0]["status"] in FITS), ends[0])
        self._record, self.loss, self.x, self._description = best
        self.status, self.work = self._record["status"], self._record["summary"]["work"]
        self.method = self._record["request"]["optimizer"]["spec"]
        kept = self._record.get("fit")
        self.y = np.array(kept["y"], float) if kept else model.y(self.x)
        self.residuals, found = self.y - model.data, self._solution()
        self.sd = self.interval = self.correlation = self._profile = None
        self.p = found.get("p")
        active = found.get("active_bounds", [""] * len(self.names))
        free = sum(not active[i] for i in model.free)
        self.degrees_of_freedom = found.get("degrees_of_freedom", len(model.data) + len(model.prior) - free)
        if "standard_deviation" in found:
            numbers = lambda name: np.array(found[name], float)
            self.sd, self.interval, self.correlation = map(numbers, ("standard_deviation", "interval", "correlation"))
            self.correlation[np.isnan(self.sd)] = self.correlation[:, np.isnan(self.sd)] = math.nan
            self._half = found["t"] * self.sd
        self._held = [i for i in model.free if (np.isnan(self.sd[i]) if self.sd is not None else active[i])]
        held = ", ".join(self.names[i] for i in self._held)
        said = filter(None, [found.get("doubt"), held and f"held at a bound: {held}", self._record["message"]])
        self.message = "; ".join(said).replace(".; ", "; ")
        nothing = 1e-10 * np.nanmax([float(record["summary"]["start_loss"]) for record, *_ in ends])  # zero residuals
        self.basins, self.calls = self._basins(nothing), model.calls

    def _solution(self, *more):
        """What `isoline solution` says of the best run."""
        request = self._record["request"]
        words = ["solution", self.out, "--problem", request["problem"]["spec"], "--optimizer", request["optimizer"]["spec"],
                 "--format", "json", *more]
        return _run(words, self._workers, self._model, self._description, out="solution.json")[0]

    def _basins(self, nothing):
        """Ends whose losses agree to 1e-4, or by the loss `nothing`, and whose unknowns agree to 1e-2 are one minimum."""
        found, size = [], 1e-9 * max(abs(self._model.x0))
        for *_, loss, x in self.runs:
            if not math.isfinite(loss):
                continue  # its start failed
            same = [each for each in found if abs(loss - each[1]) <= 1e-4 * each[1] + nothing and np.allclose(x, each[2], 1e-2, size)]
            found += [] if same else [[0, loss, x]]
            (same or found[-1:])[0][0] += 1
        return [tuple(basin) for basin in found]

    def profile(self, names=None):
        """Profile-likelihood intervals: a Profile. Each value of an unknown is tried with all others fitted again.

        A value belongs to the interval if S ≤ S_min (1 + t²/ν), as of lmfit's conf_interval. Prints how many
        calls of forward to expect. names: of these unknowns only. Raises Refused where the point is not a fit.
        """
        if self.sd is None:
            raise Refused(f"a profile requires a fit with standard deviations. {self.message}")
        self._profile = Profile(self, [] if names is None else names)
        return self._profile

    def _rows(self):
        """The head, and the parameters, as text."""
        rows = [["name", "unit", "x", f"± t·sd (95 %, ν = {self.degrees_of_freedom})", "sd", "interval"]]
        for i, name in enumerate(self.names):
            kinds = (self._model.fixed, "fixed"), (self._model.tied, "tied"), (self._held, "at its bound")
            row = [next((kind for all_of, kind in kinds if i in all_of), ""), "", ""]
            if self.sd is not None and self.sd[i] > 0:
                low, high = self.interval[i]
                row = [f"{self._half[i]:.2g}", f"{self.sd[i]:.2g}", f"{low:.5g} … {high:.5g}"]
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

    names: of the profiled unknowns. interval: an array (len(names), 2); ±infinity where the profile stays flat, NaN
    where a better fit was found. points: by name, the (value, S/S_min) tried. messages: what limits an interval.
    calls: of forward.
    """

    def __init__(self, fit, wanted):
        before = fit._model.calls
        found = fit._solution("--profile", "--trust", *(word for name in wanted for word in ("--unknown", name)))["profile"]
        self.calls, self.names = fit._model.calls - before, [each["unknown"] for each in found]
        self.interval = np.array([[each["low"], each["high"]] for each in found], float)
        self.points = {each["unknown"]: [(value, 1 + rise / fit.degrees_of_freedom)
                                         for value, rise in zip(each["value"], each["rise"])] for each in found}
        self.messages = [message for each in found for message in each["messages"]]
        fit._model.show(math.inf, is_last=True)

    def rows(self):
        ends = [[name, f"{low:.5g} … {high:.5g}"] for name, (low, high) in zip(self.names, self.interval)]
        return [["name", "profile interval (95 %)"], *ends]

    def table(self):
        return "\n".join(_text_table(self.rows()) + self.messages)

    __repr__ = table
