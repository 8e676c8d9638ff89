"""Isoline from Python: a fit of a function to data, a simulator as a problem, a method as an optimizer.

It needs the standard library only, and uses NumPy if that is installed. `fit` and `read_data` are in
isoline_fit.py; a script or a notebook calls them. For problem() and optimizer(), this one file is
enough: Isoline starts the script that imports this module:

    isoline run --problem 'process[command="python3 mine.py"]'

Both exchange frames over a private socket, so the script may print anything. docs/serving-problems.md
describes the frames; docs/bring-a-simulator.md and docs/bring-an-optimizer.md have examples.
"""

import array
import atexit
import collections
import importlib
import json
import math
import os
import platform
import re
import select
import shlex
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import warnings
import zlib

try:
    import numpy
except ImportError:  # numbers are lists then
    numpy = None

PROTOCOL = 1
HELLO, LINEARIZE, PUSHFORWARD, PULLBACK, JACOBIAN, INVERSE, X_ERROR = 1, 2, 3, 4, 5, 6, 7
BEGIN, VALUE, GRADIENT, VALUE_AND_GRADIENT, RESIDUAL = 16, 17, 18, 19, 20
RESIDUAL_JACOBIAN, RESIDUAL_PUSHFORWARD, RESIDUAL_PULLBACK, HESSIAN_PRODUCT = 21, 22, 23, 24
REPORT, FINISH, CLAIM = 32, 33, 34
DONE, FAILED, STOP = 0, 1, 2
HEAD = struct.Struct("<IIQ")
MOST_TEXT = 60_000  # bytes; Isoline accepts 64 KiB


class Stop(SystemExit):
    """The run is over: the budget is spent or the target is reached. Exits the script silently."""

    was_raised = False

    def __init__(self):
        super().__init__(0)
        Stop.was_raised = True


class Refused(RuntimeError):
    """Isoline or the problem refused a request; the message gives the reason."""


def __getattr__(name):
    if name not in ("fit", "read_data"):
        raise AttributeError(f"module 'isoline' has no attribute {name!r}")
    import isoline_fit  # loaded for fits only: Isoline starts scripts many times

    return getattr(isoline_fit, name)


# --- numbers: arrays of NumPy, or lists


def _real(values, name):
    """An array of doubles without gaps, or a list of numbers. Refuses what doubles cannot hold."""
    if values is None:
        raise Refused(f"{name} is None; does the function that computes it lack a return?")
    if hasattr(values, "detach"):  # a tensor of torch
        values = values.detach().cpu().numpy()
    if numpy is None:
        return list(_flat(values, name))
    if numpy.ma.is_masked(values):
        raise Refused(f"{name} has masked entries; fill or remove them")
    found = numpy.asarray(values)
    if found.dtype.kind == "O" and any(each is None for each in found.flat):
        raise Refused(f"{name} contains None instead of a number")
    if found.dtype.kind not in "buifO":
        raise Refused(f"{name} must have only real numbers, got an array of {found.dtype}")
    return numpy.ascontiguousarray(found, dtype=numpy.float64)


def _column(values, name="the result"):
    """A flat array of doubles, which supports the buffer protocol."""
    found = _real(values, name)
    return array.array("d", found) if numpy is None else found.reshape(-1)


def _flat(values, name):
    for each in values if hasattr(values, "__iter__") else [values]:
        if hasattr(each, "__iter__") and not isinstance(each, str):
            yield from _flat(each, name)
        elif each is None or isinstance(each, (str, complex)):
            raise Refused(f"{name} must have only real numbers, got {each!r}")
        else:
            yield float(each)


def _copy(x):
    """For functions of the user, which may change their arguments."""
    return x.copy() if hasattr(x, "copy") else x


def _text(words):
    """UTF-8 of a length that Isoline accepts."""
    return str(words).encode(errors="replace")[:MOST_TEXT]


def _vector(buffer):
    """A copy of the doubles in a buffer."""
    if numpy is not None:
        return numpy.frombuffer(buffer, dtype=numpy.float64).copy()
    return array.array("d", bytes(buffer)).tolist()


def _by_columns(matrix, rows, columns):
    """A matrix of any package, flattened column by column."""
    flat = _real(matrix, "jacobian")
    count = len(flat) if numpy is None else flat.size
    if count != rows * columns:
        raise Refused(f"jacobian must return {rows} × {columns} numbers, got {count}")
    if rows != columns and _shape(matrix) == (columns, rows):
        raise Refused(f"jacobian must return {rows} rows of {columns} numbers, got its transpose")
    if numpy is not None:
        return flat.reshape(rows, columns).T.reshape(-1)
    return array.array("d", (flat[i * columns + j] for j in range(columns) for i in range(rows)))


def _shape(matrix):
    """Of an array, or of a list of lists."""
    if hasattr(matrix, "shape"):
        return tuple(matrix.shape)
    return (len(matrix), len(matrix[0])) if hasattr(matrix[0], "__len__") else (len(matrix),)


def _json_numbers(values, name):
    return [x if x - x == 0 else str(x) for x in (float(each) for each in _column(values, name))]


# --- the socket


class _Line:
    def __init__(self, descriptor):
        self.socket = socket.socket(fileno=descriptor)
        self.buffer = bytearray(1 << 16)
        self.view = memoryview(self.buffer)

    def send(self, verb, status, *parts):
        views = [memoryview(part).cast("B") for part in parts if len(part)]
        head = HEAD.pack(verb, status, sum(map(len, views)))
        whole = HEAD.size + sum(map(len, views))
        sent = self.socket.sendmsg([head, *views])
        if sent < whole:
            self.socket.sendall(b"".join([head, *views])[sent:])

    def receive(self):
        """The verb, the status and the payload of a frame. The payload is valid until the next call."""
        got = self.socket.recv_into(self.buffer)
        while got < HEAD.size:
            got += self._more(got)
        verb, status, count = HEAD.unpack_from(self.buffer)
        whole = HEAD.size + count
        if whole > len(self.buffer):
            self.view.release()
            self.buffer.extend(bytes(whole - len(self.buffer)))
            self.view = memoryview(self.buffer)
        while got < whole:
            got += self._more(got)
        return verb, status, self.view[HEAD.size : whole]

    def _more(self, got):
        more = self.socket.recv_into(self.view[got:]) if got else 0
        if more == 0:
            raise Stop  # Isoline has closed the socket
        return more


_line, _greeting = None, None


def _greeted():
    """The line and the first message from Isoline; connects at the first call."""
    global _line, _greeting
    if _line is not None:
        return _line, _greeting
    descriptor = os.environ.get("ISOLINE_FD")
    if descriptor is None:
        script = sys.argv[0] or "mine.py"
        sys.exit(
            "Isoline starts this script; run, for example:\n"
            f"  isoline check 'process[command=\"python3 {script}\"]'"
        )
    _line = _Line(int(descriptor))
    _, _, payload = _line.receive()
    _greeting = json.loads(bytes(payload))
    return _line, _greeting


def seed():
    """The seed of this run; seed 0 is the published instance."""
    return int(_greeted()[1].get("seed", 0))


_declared, _tunable, _has_introduced = [], None, False


def option(name, default, doc="", tunable=False):
    """The value of an option of this script: of process[command="python3 mine.py",name=value].

    The option has the type of its default: a number, a whole number, true or false, or a string.
    Call option() before problem() or optimizer(). tunable=True: `isoline tune` looks for the best
    value of this option of an optimizer.
    """
    global _tunable
    if _has_introduced:
        raise Refused(f"option('{name}') must be called before problem() or optimizer()")
    given = _greeted()[1].get("options", {})
    _declared.append({"name": name, "default": default, "doc": doc})
    _tunable = name if tunable else _tunable
    return given.get(name, default)


def _refuse(line, why):
    """Sends the reason instead of a description; Isoline shows it."""
    line.send(HELLO, FAILED, _text(why))
    raise Stop


def _introduce(line, greeting, role, said):
    global _has_introduced
    if greeting["role"] != role:
        own, other = (("an " if each == "optimizer" else "a ") + each for each in (role, greeting["role"]))
        _refuse(line, f"this script is {own}, but the command uses it as {other}")
    packages = {}
    for name in ("numpy", "scipy", "torch", "jax"):
        module = sys.modules.get(name)
        if module is not None:
            packages[name] = str(getattr(module, "__version__", "unknown"))
    said.update(
        protocol=PROTOCOL,
        role=role,
        interpreter=f"{platform.python_implementation()} {platform.python_version()}",
        packages=packages,
        options=_declared or None,
        tunable=_tunable,
    )
    if clash := [each["name"] for each in _declared if each["name"] in (said.get("words") or ())]:
        _refuse(line, f"the option {clash[0]} is a word of the fit, too; give one of them another name")
    _has_introduced = True
    for name, words in said.items():
        if isinstance(words, str):
            said[name] = words.encode(errors="replace").decode()  # JSON has no single surrogates
    line.send(HELLO, DONE, json.dumps({k: v for k, v in said.items() if v is not None}).encode())


# --- problems


class _Point:
    """A forward pass, with the data that its products need."""

    def __init__(self, problem, x):
        self.problem, self.x, self.matrix = problem, x, None
        self.y = problem.forward_at(self, x)

    def pullback(self, u):
        return self.problem.pull(self, u)

    def pushforward(self, v):
        return self.problem.push(self, v)

    def jacobian(self):
        if self.matrix is None:
            self.matrix = self.problem.matrix(self)
        return self.matrix


class _Nowhere:
    """A point at which forward has no value: y and all products are NaN."""

    def __init__(self, n, m):
        self.n, self.m, self.y = n, m, _nans(m)

    def pullback(self, _):
        return _nans(self.n)

    def pushforward(self, _):
        return _nans(self.m)

    def jacobian(self):
        return _nans(self.n * self.m)


def _nans(count):
    return _column([float("nan")] * count)


def _valued(compute, without):
    """What compute() returns. If a formula overflows, divides by zero or leaves its domain: without()."""
    try:
        return compute()
    except ArithmeticError:
        return without()
    except ValueError as error:
        if str(error) != "math domain error":
            raise
        return without()


class _Given:
    """Products from functions of the user."""

    def __init__(self, forward, vjp, jvp, jacobian):
        self.forward, self.vjp, self.jvp, self.jac = forward, vjp, jvp, jacobian
        given = {"pullback": vjp, "pushforward": jvp, "jacobian": jacobian}
        self.oracles = [name for name, function in given.items() if function is not None]

    def forward_at(self, _, x):
        return _column(self.forward(_copy(x)), "forward(x)")

    def pull(self, point, u):
        return _column(self.vjp(_copy(point.x), u), "vjp(x, u)")

    def push(self, point, v):
        return _column(self.jvp(_copy(point.x), v), "jvp(x, v)")

    def matrix(self, point):
        return self.jac(_copy(point.x))


class _Torch(_Given):
    """Products by torch.autograd, from the graph of the single forward pass."""

    def __init__(self, forward):
        super().__init__(forward, True, True, None)
        self.torch = sys.modules["torch"]

    def forward_at(self, point, x):
        point.leaf = self.torch.tensor(x, dtype=self.torch.float64, requires_grad=True)
        point.graph = self.forward(point.leaf).reshape(-1)
        return _column(point.graph)

    def pull(self, point, u):
        weight = self.torch.as_tensor(u, dtype=self.torch.float64)
        return _column(self._gradient(point.graph, point.leaf, weight, point.x))

    def push(self, point, v):  # Jᵀ u is linear in u; its pullback is J
        u = self.torch.zeros_like(point.graph, requires_grad=True)
        pulled = self._gradient(point.graph, point.leaf, u, point.x, True)
        weight = self.torch.as_tensor(v, dtype=self.torch.float64)
        return _column(self._gradient(pulled, u, weight, point.y))

    def _gradient(self, of, by, weight, like, graph=False):
        found = self.torch.autograd.grad(
            of, by, weight, retain_graph=True, create_graph=graph, allow_unused=True
        )[0]
        return self.torch.zeros(len(like), dtype=self.torch.float64) if found is None else found


class _Jax(_Given):
    """Products by jax.linearize and its transpose."""

    def __init__(self, forward):
        super().__init__(forward, True, True, None)
        self.jax = sys.modules["jax"]
        self.jax.config.update("jax_enable_x64", True)

    def forward_at(self, point, x):
        point.at = self.jax.numpy.asarray(x)
        flat = lambda z: self.jax.numpy.ravel(self.forward(z))
        y, point.push = self.jax.linearize(flat, point.at)
        return _column(y)

    def pull(self, point, u):
        transpose = self.jax.linear_transpose(point.push, point.at)
        return _column(transpose(self.jax.numpy.asarray(u))[0])

    def push(self, point, v):
        return _column(point.push(self.jax.numpy.asarray(v)))


def _products_of(forward, start, vjp, jvp, jacobian, differences):
    if vjp or jvp or jacobian or differences:
        return _Given(forward, vjp, jvp, jacobian)
    for name, kind in (("torch", _Torch), ("jax", _Jax)):
        if name not in sys.modules:
            continue
        try:
            kind(forward).forward_at(_Empty(), start)
        except (TypeError, AttributeError, RuntimeError):
            continue  # forward does not work with numbers of this package
        return kind(forward)
    return _Given(forward, None, None, None)


class _Empty:
    pass


def problem(
    forward,
    start,
    target=None,
    truth=None,
    vjp=None,
    jvp=None,
    jacobian=None,
    inverse=None,
    inverse_kind="exact",
    differences=False,
    drawn=None,
    minimum=None,
    bounds=None,
    active_bounds=False,
    names=None,
    units=None,
    aim=None,
    name=None,
    note=None,
    source=None,
    start_scale=None,
    x_error=None,
    x_floor=None,
    *,
    fixed=(),
    tied=None,
    log=(),
    sigma=None,
    weights=None,
    prior=None,
    starts=None,
):
    """Serves a problem to Isoline: find x with forward(x) = target, from `start`. Never returns.

    forward(x) -> y. Products with the Jacobian come from one of these:
    - vjp(x, u) -> Jᵀu, jvp(x, v) -> Jv, jacobian(x) -> (m, n), if passed;
    - torch or jax, if forward takes and returns their arrays;
    - central differences, with differences=True, inside the bounds. Their steps follow from the noise of y,
      which six calls at the start measure, so y may have six digits. Their cost is counted.
    Otherwise, the problem does not offer derivatives.

    target: numbers; or data as read_data() reads them, also by their path, with their sigma and x axis.
    fixed, tied, log, sigma, weights, prior: words of a model fit, as of fit(). starts: the starts 1 to N − 1
        are a Latin hypercube over the bounds. `process[…,sigma=0.02]` sets a word in place of these.
    inverse(y, x0) -> x, or None if it does not find a solution.
    truth: the x that produced the target.
    drawn: the starting point for this seed(), instead of one that Isoline samples around `start`.
    bounds=(lower, upper): numbers or lists; Isoline does not call forward outside them.
    active_bounds=True: the solution may lie on a bound; other methods than those that respect
        bounds do not apply.
    names, units: of the unknowns, such as ["k", "c"] and ["N/m", "kg/s"], where reports show x. The
        names of a command are those of its template.
    aim="x": the success criterion is the error in x, not the loss.
    start_scale="own": the unknowns of random starts have a standard deviation of a tenth of |start|,
    instead of a tenth of max(1, |start|).
    x_error(x) -> number: the distance to the nearest solution; by default, the distance to `truth`.
    x_floor: the error in x of the best truncated SVD. A run with at most 1.1 times
    this error counts as solved.
    """
    line, greeting = _greeted()
    try:
        start = _vector(_column(start, "start"))
        if minimum is not None and not abs(float(minimum)) < float("inf"):
            raise Refused(f"minimum must be a finite number, got {minimum}")
        products = _products_of(forward, start, vjp, jvp, jacobian, differences)
        if isinstance(forward, command):
            names = forward.names if names is None else names
            note = " ".join(filter(None, (note, forward.note()))) or None
        names, units = _labels(names, len(start), "names"), _labels(units, len(start), "units")
        if isinstance(target, (str, os.PathLike)) or hasattr(target, "itertuples"):
            target = __getattr__("read_data")(target)
        axis = None
        if hasattr(target, "columns"):
            axis, sigma = _axis(target), target.sigma if sigma is None and weights is None else sigma
            target = target.y
        words = _words(names, len(start), fixed, tied, log, sigma, weights, prior, starts, axis)
        if target is None and truth is not None:
            target = _Point(products, _vector(_column(truth, "truth"))).y
            minimum = 0.0 if minimum is None else minimum
        if target is None:  # else there is no call at the start of a slow program
            target = [0.0] * len(_Point(products, start).y)
        target = _json_numbers(target, "target")
        drawn = None if drawn is None else _json_numbers(drawn, "drawn")
        truth = None if truth is None else _json_numbers(truth, "truth")
    except Refused as error:
        _refuse(line, error)
    _introduce(
        line,
        greeting,
        "problem",
        {
            "name": name,
            "note": note,
            "source": source,
            "inputs": len(start),
            "outputs": len(target),
            "oracles": ["forward"] + products.oracles + (["inverse"] if inverse else []),
            "differences": bool(differences) and not (vjp or jvp or jacobian),
            "inverse": inverse_kind if inverse else None,
            "start": _json_numbers(start, "start"),
            "drawn": drawn,
            "target": target,
            "truth": truth,
            "minimum": None if minimum is None else float(minimum),
            "start_scale": start_scale,
            "has_x_error": x_error is not None,
            "x_floor": x_floor,
            "bounds": None if bounds is None else [_bound(side, start) for side in bounds],
            "active_bounds": bool(active_bounds),
            "names": names,
            "units": units,
            "aim": aim,
            "words": words,
        },
    )
    _serve(line, products, inverse, x_error, len(start), len(target))


def _axis(data):
    """The word `axis` of data of read_data(), for the picture of the fit."""
    plain = lambda name: re.sub(r"[;,]", " ", str(name)).strip() or "?"
    places = [repr(each) for each in map(float, data[data.x])] if data.x else []
    return "; ".join([plain(data.x or "number of the datum"), plain(data.y_name), *places])


def _words(names, count, fixed=(), tied=None, log=(), sigma=None, weights=None, prior=None, starts=None, axis=None):
    """The words of a model fit as options of Isoline: texts, and the number of starts. Names or numbers of unknowns."""
    names = [each or f"x{i + 1}" for i, each in enumerate(names or [""] * count)]
    name = lambda which: names[which] if isinstance(which, int) and which < count else str(which)
    texts = {
        "fixed": [f"{name(each)}={float(value)!r}" for each, value in fixed.items()] if isinstance(fixed, dict)
        else [fixed] if isinstance(fixed, str) else map(name, fixed),
        "tied": [f"{name(each)} = {words}" for each, words in (tied or {}).items()],
        "log": [log] if isinstance(log, str) else map(name, log),
        "sigma": [] if sigma is None else (repr(each) for each in map(float, _column(sigma, "sigma"))),
        "weights": [] if weights is None else (repr(each) for each in map(float, _column(weights, "weights"))),
        "prior": [f"{name(each)} = {float(mean)!r} ± {float(sd)!r}" for each, (mean, sd) in (prior or {}).items()],
    }
    words = {word: "; ".join(text) for word, text in texts.items()}
    words.update(axis=axis, starts=starts and int(starts))
    return {word: given for word, given in words.items() if given} or None


def _labels(given, count, what):
    """One text for each unknown, as names and units are."""
    if given is None:
        return None
    if isinstance(given, str) or len(given) != count:
        raise Refused(f"{what} must be a list with a text for each of the {count} numbers of start, got {given!r}")
    return [str(each or "") for each in given]


class command:
    """forward(x) by a program of any language, which reads a file and writes numbers.

    run: the command, such as "./model in.txt". It runs in a new, empty folder for each call. Words of
        it that name files in the present folder are passed with their full paths.
    template: a file with "~ name ~" where the value of that unknown goes; with a first line "ptf ~", a
        template of PEST, whose fields keep their widths and hold as many digits as fit. `names` are in
        the order of their first occurrence; upper and lower case are the same. Its result is the file
        `input` in the new folder; by default the name of the template with the suffix .txt.
    read: the name of the file that contains the results, of which all words that are numbers count;
        or a function that gets the new folder and returns numbers. Default: what the program prints.
    instructions: an instruction file of PEST, by which the results are read instead.
    files: further files of the present folder that the program finds in its own.
    seconds: after so long, the program and all that it started are killed.

    If the program exits with a code other than 0, is killed, reports an error, or leaves no numbers,
    the call raises RuntimeError: a failed evaluation. What it leaves running is killed.
    """

    def __init__(self, run, template, read=None, input=None, files=(), seconds=None, instructions=None):
        if seconds is not None and not 0 < float(seconds) <= 1e6:
            raise Refused(f"seconds must be a positive number of at most 1e6, or None, got {seconds!r}")
        self.read, self.seconds = read, seconds and float(seconds)
        self.files = [os.path.abspath(each) for each in files]
        self.input = input or os.path.splitext(os.path.basename(template))[0] + ".txt"
        self.words = [
            os.path.abspath(word) if os.path.isfile(word) and word != self.input else word
            for word in shlex.split(run)
        ]
        self.instructions = _instructions(instructions) if instructions else None
        with open(template, encoding="utf-8", errors="surrogateescape") as file:
            text = file.read()
        marked = re.match(r"ptf[ \t]+(\S)[^\n]*\n", text, re.IGNORECASE)
        self.is_pest = marked is not None
        self.mark, self.text = (marked[1], text[marked.end() :]) if marked else ("~", text)
        self.parts = self.text.split(self.mark)
        if len(self.parts) < 3 or len(self.parts) % 2 == 0:
            raise Refused(f"{template} must contain each unknown as {self.mark} name {self.mark}")
        fields = self.parts[1::2]
        for i in range(2, len(self.parts) - 1, 2):
            if not self.is_pest and self.parts[i] == "":
                raise Refused(
                    f"{template}: the adjacent fields {self.parts[i - 1].strip()} and "
                    f"{self.parts[i + 1].strip()} would become one word; put a space between them, or "
                    f"begin the file with a line 'ptf {self.mark}', which keeps their widths"
                )
        for field in fields:
            if not field.strip().isprintable() or not field.strip() or "\n" in field:
                raise Refused(f"{template}: a field must be {self.mark} name {self.mark} in one line, got {field!r}")
        typed = {field.strip().lower(): field.strip() for field in reversed(fields)}
        self.names = [typed[name] for name in dict.fromkeys(field.strip().lower() for field in fields)]
        self.digits = min(len(field) + 2 - len("-.e-10") for field in fields) if self.is_pest else 17
        _remove_abandoned()

    def note(self):
        """What its fields do to x; None where they hold all digits."""
        if self.digits >= 17:
            return None
        return f"The narrowest field of the template holds about {max(self.digits, 1)} digits of x."

    def _field(self, name, value):
        if not self.is_pest:
            return f"{value:.17g}"
        width = len(name) + 2 * len(self.mark)
        for digits in range(17, 0, -1):
            for text in (f"{value:.{digits}g}", re.sub(r"e([+-])0*(\d)", r"e\1\2", f"{value:.{digits - 1}e}")):
                text = text.replace("e+", "e")
                if len(text) > width:
                    text = text.replace("0.", ".", 1) if text.lstrip("-").startswith("0.") else text
                if len(text) <= width:
                    return text.rjust(width)
        raise RuntimeError(f"the field {name.strip()} has a width of {width} characters, which cannot hold {value:g}")

    def __call__(self, x):
        values = dict(zip((name.lower() for name in self.names), map(float, x)))
        parts = [
            self._field(part, values[part.strip().lower()]) if i % 2 else part
            for i, part in enumerate(self.parts)
        ]
        with tempfile.TemporaryDirectory(prefix=f"{_folder_prefix()}{os.getpid()}-", ignore_cleanup_errors=True) as folder:
            for path in self.files:
                os.symlink(path, os.path.join(folder, os.path.basename(path)))
            with open(os.path.join(folder, self.input), "w", encoding="utf-8", errors="surrogateescape") as file:
                file.write("".join(parts))
            return self._results(folder, self._printed(folder))

    def _printed(self, folder):
        """Runs the program in a group of its own, which ends with it: no pipe is waited for."""
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            guard = _guard()
            begun = lambda: os.write(guard, f"{os.getpid()} {folder}\n".encode())
            child = subprocess.Popen(
                self.words, cwd=folder, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                start_new_session=True, preexec_fn=begun,
            )
            try:
                is_over = _await(child.pid, self.seconds)
            finally:  # before it is waited for: no other process can have the number of its group
                _kill_group(child.pid)
                child.wait()
                os.write(guard, b"\n")
            if not is_over:
                raise RuntimeError(f"the program ran for more than {self.seconds} s")
            printed, complaints = (_text_of(file) for file in (out, err))
        if child.returncode != 0:
            last = (complaints.strip() or printed.strip() or "no output").splitlines()[-1].strip()
            raise RuntimeError(f"exit code {child.returncode}: {last}")
        _refuse_errors(printed, "the output")
        return printed

    def _results(self, folder, printed):
        if callable(self.read):
            return self.read(folder)
        name = self.read or "the output"
        if self.read is not None:
            path = os.path.join(folder, self.read)
            if not os.path.isfile(path):
                last = (printed.strip() or "nothing").splitlines()[-1][:200]
                raise RuntimeError(f"the program did not write {self.read}; it printed: {last}")
            with open(path, encoding="utf-8", errors="replace") as file:
                printed = file.read()
            _refuse_errors(printed, name)
        numbers = _read_by(self.instructions, printed, name) if self.instructions else _numbers(printed, name)
        if not numbers:
            near = re.search(r"(?<!\S)[+-]*\.?[0-9]\S*", printed)
            raise RuntimeError(f"{name} contains no numbers" + (f"; {near[0][:64]!r} is not a number" if near else ""))
        return numbers


# As programs write them; Fortran has the exponents d and q, and none before three digits.
_NUMBER = re.compile(
    r"[+-]?(?:(?:\d+\.?\d*|\.\d+)(?:[eEdDqQ][+-]?\d+)?|(?:\d+\.\d*|\.\d+)[+-]\d{3}|nan|inf(?:inity)?)", re.ASCII | re.IGNORECASE
)
_BEGINS = re.compile(r"[+-]?\.?\d")  # as numbers do
_LIKE_NUMBER = re.compile(rf"{_BEGINS.pattern}[\d_.eEdDqQ+-]*")
_OVERFLOW = re.compile(r"[+-]?\*{2,25}")
_ERROR = re.compile(r"\W*(?:(?:FATAL\W+)?ERROR\b|(?i:(?:fatal\W+)?error\s*:(?!\s*[+-]?\.?\d)))")


def _number(word, name):
    """Of a word that is one; RuntimeError otherwise."""
    if _OVERFLOW.fullmatch(word):
        raise RuntimeError(f"{name} has an overflow: {word}")
    if not _NUMBER.fullmatch(word):
        raise RuntimeError(f"{name} has {word!r} in place of a number")
    plain = re.sub(r"[dDqQ]", "e", word) if not word.lstrip("+-")[:1].isalpha() else word
    return float(re.sub(r"(?<=[\d.])([+-]\d{3})$", r"e\1", plain))


def _refuse_errors(text, name):
    for line in filter(_ERROR.match, text.splitlines()):
        raise RuntimeError(f"{name} reports an error: {line.strip()[:200]}")


def _numbers(text, name):
    numbers = []
    for line in text.splitlines():
        words = line.replace(",", " ").split()
        whole = [_NUMBER.fullmatch(word) or _OVERFLOW.fullmatch(word) for word in words]
        is_data = any(whole) and all(each or _BEGINS.match(word) for each, word in zip(whole, words))
        is_banner = bool(words) and not is_data and words[0].strip("*") == ""
        for word in words:  # others stand between the numbers
            is_wanted = is_data or _NUMBER.fullmatch(word) or _LIKE_NUMBER.fullmatch(word)
            if is_wanted or (_OVERFLOW.fullmatch(word) and not is_banner):
                numbers.append(_number(word, name))
    return numbers


def _instructions(path):
    """The instruction lines of a file of PEST, each a list of words."""
    with open(path, encoding="utf-8", errors="replace") as file:
        lines = file.read().splitlines()
    first = re.match(r"pif[ \t]+(\S)\s*$", lines[0] if lines else "", re.IGNORECASE)
    if not first:
        raise Refused(f"{path}: the first line of an instruction file must be 'pif' and a mark, such as 'pif @'")
    mark = re.escape(first[1])
    places = r"\d{1,9}:\d{1,9}"
    word = re.compile(rf"\s*({mark}[^{mark}]+{mark}|![^!\s]+!|\[[^\]\s]+\]{places}|\([^)\s]+\){places}|[lLtT]\d{{1,9}}|[wW]|&)(?=\s|$)")
    all_lines = []
    for number, line in enumerate(lines[1:], 2):
        words, at = [], 0
        while line[at:].strip():
            found = word.match(line, at)
            if not found:
                raise Refused(f"{path}, line {number}: cannot read the instruction {line[at:].strip()!r}")
            words.append(found[1])
            at = found.end()
        if "&" in (words[1:] if all_lines else words):
            raise Refused(f"{path}, line {number}: & continues the line before it, and stands first")
        if words[:1] == ["&"]:
            all_lines[-1] += words[1:]
        elif words:
            all_lines.append(words)
    if not any(word[0] in "![(" and word.lower() != "!dum!" for words in all_lines for word in words):
        raise Refused(f"{path} names no observation")
    return first[1], all_lines


def _read_by(instructions, text, name):
    """The observations, in the order of the instructions."""
    mark, instruction_lines = instructions
    lines, at, numbers = text.splitlines(), -1, []

    def missing(word):
        return RuntimeError(f"{name} ends before the instruction {word}")

    for words in instruction_lines:
        column = 0
        for i, word in enumerate(words):
            kind = word[0].lower()
            if kind == mark.lower() and word[-1] == word[0] and len(word) > 1:
                wanted = word[1:-1]
                if i == 0:
                    at += 1
                    while at < len(lines) and wanted not in lines[at]:
                        at += 1
                    if at >= len(lines):
                        raise missing(word)
                    column = lines[at].index(wanted) + len(wanted)
                    continue
                found = lines[at].find(wanted, column) if at >= 0 else -1
                if found < 0:
                    raise RuntimeError(f"{name}, line {at + 1}: no {wanted!r} for the instruction {word}")
                column = found + len(wanted)
                continue
            if kind == "l":
                at, column = at + int(word[1:]), 0
                if at >= len(lines):
                    raise missing(word)
                continue
            if not 0 <= at < len(lines):
                raise missing(word)
            line = lines[at]
            if kind == "t":
                column = int(word[1:]) - 1
            elif kind == "w":
                found = re.compile(r"\s+").search(line, column)
                if not found:
                    raise RuntimeError(f"{name}, line {at + 1}: no blank for the instruction {word}")
                column = found.end()
            else:
                if kind == "!":
                    found = re.compile(r"[\s,]*([^\s,]+)").match(line, column)
                    value, observation = (found[1] if found else ""), word[1:-1]
                    column = found.end() if found else column
                else:
                    observation, first, last = re.fullmatch(r"[\[(](.+)[\])](\d+):(\d+)", word).groups()
                    begin, column = int(first) - 1, int(last)
                    if kind == "(":  # the word that lies in these columns, whole
                        found = next((each for each in re.finditer(r"[^\s,]+", line)
                                      if each.end() > begin and each.start() < column), None)
                        value, column = (found[0], found.end()) if found else ("", column)
                    else:
                        value = line[begin:column].strip()
                if observation.lower() != "dum":
                    numbers.append(_number(value, f"{name}, line {at + 1}, observation {observation},"))
    return numbers


# --- programs end by their group, with their folder

_guards = {}  # by thread of a process: a pipe to a shell that outlives this process


def _guard():
    """A pipe that takes lines "GROUP FOLDER". When this process is gone, both of the last line end."""
    thread = os.getpid(), threading.get_ident()
    if thread not in _guards or _guards[thread][0].poll() is not None:
        work = ('trap "" 1 2 15; while read -r a b; do group=$a; folder=$b; done; '
                '[ -z "$group" ] || kill -s KILL -- "-$group" 2>/dev/null; '
                '[ -z "$folder" ] || rm -rf -- "$folder" || rm -rf -- "$folder"')
        shell = subprocess.Popen(["sh", "-c", work], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.DEVNULL, cwd="/", start_new_session=True)
        _guards[thread] = (shell, os.dup(shell.stdin.fileno()))
        os.set_inheritable(_guards[thread][1], False)
        shell.stdin.close()
    return _guards[thread][1]


def _kill_group(group):
    try:
        os.killpg(group, signal.SIGKILL)
    except (ProcessLookupError, PermissionError):
        pass


def _await(process, seconds):
    """Whether it ended in time. It is not waited for: its number stays taken."""
    if seconds is None:
        os.waitid(os.P_PID, process, os.WEXITED | os.WNOWAIT)
        return True
    descriptor = os.pidfd_open(process)
    try:
        waiting = select.poll()
        waiting.register(descriptor, select.POLLIN)
        return bool(waiting.poll(1000 * seconds))
    finally:
        os.close(descriptor)


def _text_of(file):
    file.seek(0)
    return file.read().decode(errors="replace")


def _folder_prefix():
    """Of the folders of this machine's processes, whose numbers belong to a namespace."""
    try:
        space = os.readlink("/proc/self/ns/pid")
    except OSError:
        space = ""
    return f"isoline-{zlib.crc32(f'{platform.node()} {space}'.encode()):08x}-"


def _remove_abandoned():
    """Folders of scripts that were killed together with what would have removed them."""
    prefix = _folder_prefix()
    with os.scandir(tempfile.gettempdir()) as entries:
        for each in entries:
            owner = each.name[len(prefix) :].split("-")[0]
            if not each.name.startswith(prefix) or not owner.isdigit() or os.path.exists(f"/proc/{owner}"):
                continue
            try:
                is_ours = each.is_dir(follow_symlinks=False) and each.stat(follow_symlinks=False).st_uid == os.getuid()
            except OSError:
                continue
            if is_ours:
                shutil.rmtree(each.path, ignore_errors=True)


def _bound(side, start):
    return _json_numbers([side] * len(start) if isinstance(side, (int, float)) else side, "bounds")


def _serve(line, products, inverse, x_error, n, m):
    points = {}
    while True:
        _reply(line, points, products, inverse, x_error, n, m)


def _reply(line, points, products, inverse, x_error, n, m):
    """Receives one request and answers it. The points of earlier forward passes are in `points`."""
    verb, number, payload = line.receive()
    try:
        if verb == X_ERROR:
            answer = [_sized(_column(x_error(_vector(payload)), "x_error(x)"), 1, "x_error")]
        else:
            answer = _answer(verb, number, payload, points, products, inverse, n, m)
    except Exception as error:  # the cell fails with this message; the traceback goes to its output
        if "ISOLINE_FD" in os.environ:
            import traceback

            traceback.print_exc()
        why = str(error) if isinstance(error, Refused) else f"{type(error).__name__}: {error}{_place_of(error)}"
        line.send(verb, FAILED, _text(why))
        return
    line.send(verb, DONE, *answer)


def _place_of(error):
    """The line of the script that raised it, or that called what did: " (mine.py, line 4)"; else an empty text."""
    frame, place, file = error.__traceback__, "", None
    while frame:
        name = frame.tb_frame.f_code.co_filename
        file = file or (name if name != __file__ else None)
        place = f" ({os.path.basename(name)}, line {frame.tb_lineno})" if name == file else place
        frame = frame.tb_next
    return place


def _answer(verb, number, payload, points, products, inverse, n, m):
    if verb == LINEARIZE:
        points[number] = tuple(
            _valued(lambda x=x: _Point(products, x), lambda: _Nowhere(n, m))
            for x in _samples(payload, n)
        )
        return [_sized(point.y, m, "forward") for point in points[number]]
    if verb == PULLBACK:
        each = zip(points[number], _samples(payload, m))
        return [_sized(_valued(lambda p=p, u=u: p.pullback(u), lambda: _nans(n)), n, "vjp") for p, u in each]
    if verb == PUSHFORWARD:
        each = zip(points[number], _samples(payload, n))
        return [_sized(_valued(lambda p=p, v=v: p.pushforward(v), lambda: _nans(m)), m, "jvp") for p, v in each]
    if verb == JACOBIAN:
        matrices = [_valued(point.jacobian, lambda: _nans(m * n)) for point in points[number]]
        return [_by_columns(matrix, m, n) for matrix in matrices]
    if verb == INVERSE:
        return _inverted(payload, inverse, n, m)
    raise Refused(f"unknown verb {verb}")


def _sized(values, count, name):
    if len(values) != count:
        raise Refused(f"{name} must return {count} numbers, got {len(values)}")
    return values


def _samples(payload, size):
    """The samples of a batch."""
    if len(payload) == 8 * size:
        return (_vector(payload),)
    return [_vector(payload[i : i + 8 * size]) for i in range(0, len(payload), 8 * size)]


def _inverted(payload, inverse, n, m):
    samples = len(payload) // (8 * (n + m))
    targets = _samples(payload[: 8 * m * samples], m)
    starts = _samples(payload[8 * m * samples :], n)
    found = [inverse(y, x0) for y, x0 in zip(targets, starts)]
    xs = [_column(x0 if x is None else x, "inverse(y, x0)") for x, x0 in zip(found, starts)]
    return [_sized(x, n, "inverse") for x in xs] + [_column([float(x is not None) for x in found])]


# --- optimizers


class optimizer:
    """An optimizer that Isoline runs: x0, and the oracles of L and of r = (y − y*)/√B.

    needs: a list of the required derivatives: "pullback", "jacobian", "pushforward", "hessian_product".
    least_squares=True: the method minimizes ½‖r‖², so it does not apply to problems with another loss.
    reports=True: the script calls report(x) once per iteration. Otherwise, each new best point counts
    as one iteration.
    keeps_bounds=True: the method evaluates only points with lower ≤ x ≤ upper; otherwise, it does not
    apply to problems whose solution may lie on a bound.
    failed=1e100: where an evaluation fails, value is this number, and so is each component of residual;
    derivatives are 0. Otherwise, all of them are NaN there.
    When the run is over, every call raises Stop, which exits the script.
    """

    def __init__(
        self, needs=(), name=None, least_squares=False, reports=False, note=None, source=None,
        keeps_bounds=False, failed=None,
    ):
        self._line, greeting = _greeted()
        self._failed = failed
        if failed is not None and note is None:
            note = f"Where an evaluation fails, the program is given values and residuals of {failed:g}."
        said = {"name": name, "note": note, "source": source, "needs": list(needs)}
        said.update(least_squares=least_squares, reports=reports, keeps_bounds=keeps_bounds)
        _introduce(self._line, greeting, "optimizer", said)
        verb, _, payload = self._line.receive()  # for a mere description, Isoline closes the socket here
        begun = _vector(payload)
        n = self.n = int(begun[0])
        self.residuals = int(begun[1])
        self.x0, bounds = begun[2 : n + 2], begun[n + 2 :]
        if len(bounds) == 0:  # the problem has none
            bounds = _vector(array.array("d", [float("-inf")] * n + [float("inf")] * n))
        self.lower, self.upper = bounds[:n], bounds[n:]
        self._watch_end()

    def value(self, x):
        """L"""
        return float(self._numbers(VALUE, x)[0])

    def gradient(self, x):
        """∇L"""
        return self._numbers(GRADIENT, x)

    def value_and_grad(self, x):
        """L and ∇L, at the cost of one forward and one pullback"""
        both = self._numbers(VALUE_AND_GRADIENT, x)
        return float(both[0]), both[1:]

    def residual(self, x):
        """r = (y − y*)/√B; for a least-squares problem, L = ½‖r‖²"""
        return self._numbers(RESIDUAL, x)

    def jacobian(self, x):
        """∂r/∂x"""
        columns = self._numbers(RESIDUAL_JACOBIAN, x)
        if numpy is not None:
            return columns.reshape(self.n, self.residuals).T
        rows = self.residuals
        return [[columns[j * rows + i] for j in range(self.n)] for i in range(rows)]

    def jvp(self, x, v):
        """(∂r/∂x) v"""
        return self._numbers(RESIDUAL_PUSHFORWARD, x, v)

    def vjp(self, x, w):
        """(∂r/∂x)ᵀ w"""
        return self._numbers(RESIDUAL_PULLBACK, x, w)

    def hvp(self, x, v):
        """∇²L v"""
        return self._numbers(HESSIAN_PRODUCT, x, v)

    def report(self, x, *_, **__):
        """An iteration has ended at x. Can serve as a callback of SciPy."""
        self._ask(REPORT, x)

    def finish(self, x, message=""):
        """Ends the run with the result x. The record contains the message."""
        if message:
            self._line.send(CLAIM, DONE, _text(message)[:1000])
            self._answer()
        self._ask(FINISH, x)
        self._is_over = True

    def _watch_end(self):
        """Prints why the run has no result, if the script ends without one."""
        self._is_over, shown = False, sys.excepthook

        def show(*error):
            self._is_over = True
            shown(*error)

        def end():
            if not (self._is_over or Stop.was_raised):
                print("isoline: the script ended without finish(x)", file=sys.stderr)

        sys.excepthook = show
        atexit.register(end)

    def _numbers(self, verb, *vectors):
        numbers = self._ask(verb, *vectors)
        if self._failed is None or all(x - x == 0 for x in numbers):
            return numbers
        values = {VALUE: 1, VALUE_AND_GRADIENT: 1, RESIDUAL: len(numbers)}.get(verb, 0)
        return _column([self._failed] * values + [0] * (len(numbers) - values))

    def _ask(self, verb, *vectors):
        self._line.send(verb, DONE, *(_column(each, "x") for each in vectors))
        return self._answer()

    def _answer(self):
        _, status, payload = self._line.receive()
        if status == STOP:
            raise Stop
        if status == FAILED:
            raise Refused(bytes(payload).decode(errors="replace"))
        return _vector(payload)


# --- results as pandas frames

KEYS = ["cell", "build"]  # which run a row belongs to, in every frame


class Results(collections.namedtuple("Results", "runs curves hits")):
    """One row per run; one per kept point of a run; one per target that was looked for."""


def package(name, debian):
    """A package of Python. Debian's Python is tried where this one lacks it; else says what to install."""
    try:
        return importlib.import_module(name)
    except ImportError:
        theirs = "/usr/bin/python3"
        if os.path.exists(theirs) and os.path.realpath(sys.executable) != os.path.realpath(theirs):
            if sys.argv[0] and os.path.exists(sys.argv[0]):
                sys.stdout.flush()
                os.execv(theirs, [theirs, *sys.argv])
    sys.exit(f"this needs the Python package {name}; on Debian, `apt-get install {debian}` installs it")


def _read_number(value):
    """JSON has no infinity and no NaN: records have them as texts."""
    if value in ("inf", "-inf", "nan"):
        return float(value)
    if value is not None and not isinstance(value, (int, float)):
        raise ValueError("a number is expected")
    if value is not None:
        float(value)  # or it is too large
    return value


def _columns_of(columns):
    """Equal columns of a part of a record, its counts by oracle as columns of their own."""
    plain = {name: values for name, values in columns.items() if name != "counts"}
    return {**plain, **{oracle: values for oracle, values in columns.get("counts", {}).items()}}


def load(*folders, only=None):
    """The records of result folders, as three frames of pandas: runs, curves, hits.

    All have the columns cell and build, which together name a run. `only` selects such pairs. A folder
    may have records of several builds of one cell; the newest is the one that reports count.

        runs, curves, hits = isoline.load("results/quick")
        curves.merge(runs[["cell", "build", "problem", "optimizer", "seed"]])
    """
    pandas = package("pandas", "python3-pandas")
    runs, curves, hits, known = [], [], [], set()
    for folder in folders:
        for file in sorted(os.scandir(os.path.join(folder, "runs")), key=lambda one: one.name):
            if not file.name.endswith(".json"):
                continue
            parts = []
            try:
                if not file.is_file():  # a pipe would be waited for
                    raise ValueError("it is not a file")
                with open(file.path, encoding="utf-8") as text:
                    record = json.load(text)
                key = {name: record[name] for name in KEYS}
                pair = (record["cell"], record["build"])
                if pair in known or (only is not None and pair not in only):
                    continue
                row = {**key, **_run(record)}
                for part, frames in (("curve", curves), ("hits", hits)):
                    if record.get(part):
                        columns = _columns_of(record[part])
                        length = len(columns["work"])
                        if any(len(column) > length for column in columns.values()):
                            raise ValueError("its columns differ in length")
                        columns = {each: [_read_number(value) for value in column] for each, column in columns.items()}
                        parts.append((frames, {**{name: [value] * length for name, value in key.items()}, **columns}))
            except (ValueError, LookupError, TypeError, AttributeError, RecursionError, OverflowError, OSError):
                if only is None:
                    warnings.warn(f"{file.path} is left out: it is not a record, see `isoline validate`", stacklevel=2)
                continue
            known.add(pair)
            runs.append(row)
            for frames, columns in parts:
                frames.append(columns)
    return Results(pandas.DataFrame(runs, columns=None if runs else KEYS), _stacked(pandas, curves),
                   _stacked(pandas, hits))


def _run(record):
    """A run as a flat row: what was asked, how it ended, and its last values."""
    request, verified = record["request"], record.get("verified", {})
    return {
        "problem": request["problem"]["spec"], "optimizer": request["optimizer"]["spec"],
        "seed": request["seed"], "status": record["status"], "message": record.get("message", ""),
        "imported": bool(record.get("imported", False)),
        **{f"verified_{tau}": verified.get(tau) for tau in ("1e-1", "1e-3", "1e-6")},
        **{name: _read_number(record.get(name)) for name in ("minimum", "scale", "x_scale")},
        **{name: _read_number(value) for name, value in record.get("summary", {}).items()},
        **{f"{oracle}_calls": _read_number(count) for oracle, count in record.get("counts", {}).items()}}


def _stacked(pandas, parts):
    """One frame of the columns of many runs; a count that a run did not keep is 0."""
    names = dict.fromkeys(name for columns in parts for name in columns)
    if not names:
        return pandas.DataFrame(columns=[*KEYS, "iteration", "work", "target", "loss"])
    figures = {"loss", "x_error", "gradient_norm", "step_norm", "wall_seconds", "processor_seconds", "target"}
    stacked = {name: [] for name in names}
    for columns in parts:
        length = len(columns["work"])
        for name, column in stacked.items():
            values = columns.get(name, ())  # shorter where it has not been kept
            column.extend(values)
            column.extend([math.nan if name in figures else 0] * (length - len(values)))
    return pandas.DataFrame(stacked).astype({name: float for name in figures & names.keys()})
