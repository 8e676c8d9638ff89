"""UM-Bridge, a protocol for models over HTTP (Seelinger et al. 2023, version 1.0), in both directions.

The model of a server becomes a problem of Isoline. Isoline starts the server, or uses a running one:

    process[command="python3 -m umbridge model --start [1,1] --target [2,3] -- python3 model.py"]
    process[command="python3 -m umbridge model --start [1,1] --target [2,3] --url http://host:4242"]

It also serves a problem of Isoline to a method in another program, which becomes an optimizer:

    process[command="python3 -m umbridge serve --port 4242 --client my-descent"]

docs/serving-problems.md has examples and all options.
"""

import argparse
import array
import ast
import atexit
import contextlib
import ctypes
import http.client
import ipaddress
import json
import math
import os
import queue
import re
import selectors
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.parse

import isoline

PR_SET_PDEATHSIG = 1  # of prctl(2)
PATIENCE = 86_400  # seconds; the limits of the cell apply first


def vector(text):
    """Numbers from "[1, 2]", or from a .npy file of doubles."""
    if not text.endswith(".npy"):
        values = json.loads(text)
        return [float(value) for value in (values if isinstance(values, list) else [values])]
    try:
        with open(text, "rb") as file:
            magic = file.read(8)
            length = int.from_bytes(file.read(2 if magic[6:7] == b"\1" else 4), "little")
            head = ast.literal_eval(file.read(length).decode("latin-1"))
            if magic[:6] == b"\x93NUMPY" and head["descr"] == "<f8":
                return array.array("d", file.read()).tolist()
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{text}: {error.strerror}") from None
    except (ValueError, SyntaxError, TypeError, LookupError, MemoryError, RecursionError):
        pass  # as below
    raise argparse.ArgumentTypeError(f"{text} must be a .npy file of numbers with the dtype <f8")


def split_by_sizes(values, sizes):
    parts, begin = [], 0
    for size in sizes:
        parts.append([float(value) for value in values[begin : begin + size]])
        begin += size
    return parts


def entry(text):
    """A name and a value from "name=value"; what is not a JSON number, true or false is text."""
    name, equals, value = text.partition("=")
    if not (name and equals):
        raise argparse.ArgumentTypeError(f"must be NAME=VALUE, got {text}")
    try:
        found = json.loads(value)
    except ValueError:
        found = value
    return name, found if isinstance(found, (bool, int, float)) else value


def number(value):
    """A number of an answer; NaN, Infinity, null and "inf" are valid."""
    return math.nan if value is None else float(value)


# --- the model of a server as a problem


class Model:
    def __init__(self, given):
        self.name, self.config, self.process = given.model, json.loads(given.config), None
        if not isinstance(self.config, dict):
            raise ValueError("--config must be a JSON object")
        for name, value in given.option:
            self.config[name] = isoline.option(name, value, "entry of the model's config")
        self.url, self.connection = given.url, None
        if given.command:
            self.start(given.command, given.startup)
        models = self.ask("/Info")["models"]
        self.name = self.name or (models[0] if len(models) == 1 else "")
        if self.name not in models:
            raise ValueError(f"--model must be one of the server's models, {', '.join(models)}; "
                             f"got '{self.name}'")
        self.inputs = self.ask("/InputSizes", name=self.name)["inputSizes"]
        self.outputs = self.ask("/OutputSizes", name=self.name)["outputSizes"]
        self.support = self.ask("/ModelInfo", name=self.name)["support"]
        if not self.support.get("Evaluate"):
            raise ValueError(f"the model '{self.name}' does not support Evaluate")

    def start(self, command, startup):
        """Starts the server with a free port in PORT, and waits until it listens."""
        with socket.create_server(("127.0.0.1", 0)) as probe:
            port = probe.getsockname()[1]
        self.url = f"http://127.0.0.1:{port}"
        libc = ctypes.CDLL(None)
        self.process = subprocess.Popen(
            command, stdout=sys.stderr, env=dict(os.environ, PORT=str(port)),
            preexec_fn=lambda: libc.prctl(PR_SET_PDEATHSIG, signal.SIGKILL))  # the server ends with this script
        atexit.register(self.end)
        deadline = time.monotonic() + startup
        while True:
            if self.process.poll() is not None:
                raise RuntimeError(f"'{' '.join(command)}' {self.ending()} before it listened")
            try:
                with socket.create_connection(("127.0.0.1", port), timeout=1):
                    return
            except OSError:
                if time.monotonic() > deadline:
                    raise RuntimeError(f"'{' '.join(command)}' did not listen at the port in PORT "
                                       f"within {startup:g} s (--startup)") from None
                time.sleep(0.02)

    def end(self):
        self.process.kill()
        self.process.wait()

    def ending(self):
        time.sleep(0.1)
        code = self.process.poll() if self.process else None
        return "is still running" if code is None else f"ended with code {code}"

    def ask(self, path, **members):
        """The object in the answer. Any other answer raises an error that names the server."""
        try:
            status, text = self.exchange(path, members)
        except (OSError, http.client.HTTPException) as error:
            end = f"the server {self.ending()}: " if self.process else ""
            raise RuntimeError(f"{end}{self.url}{path}: {error or type(error).__name__}") from None
        try:
            answer = json.loads(text)
        except ValueError:
            answer = None
        if status != 200 or not isinstance(answer, dict) or "error" in answer:
            error = answer.get("error") if isinstance(answer, dict) else None
            said = error.get("message") if isinstance(error, dict) else f"status {status}: {text[:200]}"
            raise RuntimeError(f"the model '{self.name}' refused {self.url}{path}: {said}")
        return answer

    def exchange(self, path, members):
        """One request over the open connection; connects again if the server has closed it."""
        place = urllib.parse.urlsplit(self.url)
        body = json.dumps({**members, "config": self.config}) if members else None
        for is_last in (False, True):
            try:
                if self.connection is None:
                    self.connection = http.client.HTTPConnection(place.netloc, timeout=PATIENCE)
                self.connection.request("POST" if body else "GET", place.path.rstrip("/") + path, body,
                                        {"Content-Type": "application/json"})
                # Servers that send head and body apart wait for our acknowledgement in between.
                if hasattr(socket, "TCP_QUICKACK"):
                    self.connection.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1)
                reply = self.connection.getresponse()
                return reply.status, reply.read().decode(errors="replace")
            except (ConnectionError, http.client.BadStatusLine):
                self.connection = None
                if is_last:
                    raise
        raise AssertionError

    def numbers(self, verb, size, **members):
        output = self.ask(f"/{verb}", name=self.name, **members)["output"]
        if not isinstance(output, list) or len(output) != size:
            raise RuntimeError(f"/{verb} of the model '{self.name}' must return {size} numbers, got "
                               f"{len(output) if isinstance(output, list) else output}")
        return [number(value) for value in output]

    def forward(self, x):
        x = [float(value) for value in x]
        if not all(map(math.isfinite, x)):  # many servers cannot parse such numbers
            return [math.nan] * sum(self.outputs)
        output = self.ask("/Evaluate", name=self.name, input=split_by_sizes(x, self.inputs))["output"]
        if [len(part) for part in output] != self.outputs:
            raise RuntimeError(f"/Evaluate of the model '{self.name}' must return {sum(self.outputs)} "
                               f"numbers in {len(self.outputs)} lists")
        return [number(value) for part in output for value in part]

    def product(self, verb, name, x, along, to_sizes, from_sizes):
        """Each part of the result sums the contributions of all parts of `along`."""
        result, begin = [0.0] * sum(to_sizes), 0
        given = split_by_sizes(along, from_sizes)
        is_pullback = verb == "Gradient"
        for to, size in enumerate(to_sizes):
            for source, part in enumerate(given):
                which = {"inWrt": to, "outWrt": source} if is_pullback else {"inWrt": source, "outWrt": to}
                for i, value in enumerate(self.numbers(verb, size, **which, **{name: part},
                                                       input=split_by_sizes(x, self.inputs))):
                    result[begin + i] += value
            begin += size
        return result

    def vjp(self, x, u):
        return self.product("Gradient", "sens", x, u, self.inputs, self.outputs)

    def jvp(self, x, v):
        return self.product("ApplyJacobian", "vec", x, v, self.outputs, self.inputs)


def model(given):
    server = Model(given)
    for name, size in (("start", sum(server.inputs)), ("target", sum(server.outputs)),
                       ("truth", sum(server.inputs))):
        values = getattr(given, name)
        if values is not None and len(values) != size:
            raise ValueError(f"--{name} must have {size} numbers, got {len(values)}")
    isoline.problem(
        server.forward, given.start, target=given.target, truth=given.truth, minimum=given.minimum,
        vjp=server.vjp if server.support.get("Gradient") else None,
        jvp=server.jvp if server.support.get("ApplyJacobian") else None,
        differences=given.differences, aim=given.aim, start_scale=given.start_scale,
        x_floor=given.x_floor, name=given.label or server.name, note=f"model {server.name} over UM-Bridge",
        source="Seelinger et al. (2023), protocol 1.0; the model's own")


# --- a problem of Isoline for a method in another program


class Refusal(Exception):
    def __init__(self, kind, message, status=400):
        super().__init__(message)
        self.kind, self.status = kind, status


class Served:
    """The models loss (x ↦ L), residual (x ↦ r = y − y*) and start (no input, x0) of one run."""

    VERBS = {"Evaluate": None, "Gradient": "pullback", "ApplyJacobian": "pushforward",
             "ApplyHessian": "hessian_product"}

    def __init__(self, run, offers):
        self.run, self.offers = run, offers
        self.sizes = {"loss": ([run.n], [1]), "residual": ([run.n], [run.residuals]), "start": ([], [run.n])}
        self.best, self.best_loss = run.x0, math.inf
        self.called, self.is_over = time.monotonic(), False

    def support(self, name):
        return {verb: need is None or name != "start" and need in self.offers
                and not (verb == "ApplyHessian" and name == "residual")
                for verb, need in self.VERBS.items()}

    def answer(self, path, text):
        """The answer, or for what the run computes a function that returns it."""
        if path == "Info":
            return {"protocolVersion": 1.0, "models": list(self.sizes)}
        try:
            asked = json.loads(text)
        except (ValueError, RecursionError):
            raise Refusal("InvalidInput", "the body is not JSON") from None
        name = asked.get("name") if isinstance(asked, dict) else None
        if not isinstance(name, str) or name not in self.sizes:
            raise Refusal("ModelNotFound", f"the models are {', '.join(self.sizes)}")
        if path in ("InputSizes", "OutputSizes", "ModelInfo"):
            return {"InputSizes": {"inputSizes": self.sizes[name][0]},
                    "OutputSizes": {"outputSizes": self.sizes[name][1]},
                    "ModelInfo": {"support": self.support(name)}}[path]
        if not self.support(name)[path]:
            raise Refusal("UnsupportedFeature", f"{name} does not offer {path}")
        if not isinstance(asked.get("config", {}), dict):
            raise Refusal("InvalidInput", "config must be an object")
        x = self.vectors(asked.get("input"), self.sizes[name][0], "input")
        return lambda: {"output": self.computed(path, name, asked, x[0] if x else None)}

    @staticmethod
    def vectors(values, sizes, what):
        is_good = isinstance(values, list) and len(values) == len(sizes) and all(
            isinstance(part, list) and len(part) == size and
            all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in part)
            for part, size in zip(values, sizes))
        if not is_good:
            raise Refusal("InvalidInput", f"{what} must be a list of vectors of sizes {sizes}")
        return [[float(value) for value in part] for part in values]

    def computed(self, path, name, asked, x):
        if name == "start":
            return [list(map(float, self.run.x0))]
        for key in ("outWrt", "inWrt", "inWrt1", "inWrt2"):
            if asked.get(key, 0) != 0 or isinstance(asked.get(key, 0), bool):
                raise Refusal("InvalidInput", f"{key} must be 0: the model has one input and one output")
        sens = vec = None
        if path in ("Gradient", "ApplyHessian"):
            (sens,) = self.vectors([asked.get("sens")], self.sizes[name][1], "sens")
        if path in ("ApplyJacobian", "ApplyHessian"):
            (vec,) = self.vectors([asked.get("vec")], self.sizes[name][0], "vec")
        run, is_loss = self.run, name == "loss"
        if path == "Evaluate":
            loss = run.value(x)
            if loss < self.best_loss:
                self.best, self.best_loss = x, loss
            return [[loss]] if is_loss else [list(map(float, run.residual(x)))]
        if path == "ApplyHessian":
            return [sens[0] * float(value) for value in run.hvp(x, vec)]
        if path == "Gradient":
            back = run.gradient(x) if is_loss else run.vjp(x, sens)
            return [(sens[0] if is_loss else 1.0) * float(value) for value in back]
        if is_loss:
            return [sum(float(a) * b for a, b in zip(run.gradient(x), vec))]
        return list(map(float, run.jvp(x, vec)))


class Door:
    """One thread takes requests whole; another computes, in the order in which they came."""

    patience = 60  # seconds for a whole request to arrive
    most_head = 1 << 16  # bytes before the body

    def __init__(self, served, host, port):
        self.served, self.host = served, host
        self.most_bytes = (1 << 20) + 64 * (2 * served.run.n + served.run.residuals)
        self.listening = socket.create_server((host, port), backlog=1024)  # clients that the system does not make wait
        self.listening.setblocking(False)
        self.events, self.arriving = selectors.DefaultSelector(), {}
        self.events.register(self.listening, selectors.EVENT_READ)
        self.calls, self.begun, self.done = queue.SimpleQueue(), 0, 0
        self.worker = threading.Thread(target=self.compute, daemon=True)
        self.worker.start()

    def compute(self):
        while call := self.calls.get():
            self.served.called = time.monotonic()
            self.handle(*call)
            self.served.called = time.monotonic()
            self.done += 1

    def listen(self, seconds):
        """Takes what arrives within so many seconds."""
        for key, _ in self.events.select(seconds):
            self.read(key.fileobj) if key.fileobj is not self.listening else self.accept()
        for connection, (data, deadline) in list(self.arriving.items()):
            if time.monotonic() > deadline:
                self.take(connection, data, True)

    def accept(self):
        """Takes all that wait to be connected."""
        while True:
            try:
                connection = self.listening.accept()[0]
            except BlockingIOError:
                return
            except OSError:  # it is gone again, or there are too many
                time.sleep(0.01)
                return
            connection.setblocking(False)
            self.arriving[connection] = bytearray(), time.monotonic() + self.patience
            self.events.register(connection, selectors.EVENT_READ)
            self.read(connection)

    def read(self, connection):
        data = self.arriving[connection][0]
        try:
            part = connection.recv(1 << 20)
        except BlockingIOError:
            return
        except OSError:
            part = b""
        data += part
        self.take(connection, data, not part)

    def take(self, connection, data, is_over):
        """Handles the request in the data, if it is whole or no more of it comes."""
        request = None
        try:
            request = self.request_in(data, is_over)
            make = request and (lambda: self.served.answer(*request))
        except Refusal as refusal:
            make = lambda error=refusal: self.refuse(error)
        if make or is_over:
            self.events.unregister(connection)
            del self.arriving[connection]
            self.handle(connection, make) if make else connection.close()

    @staticmethod
    def refuse(error):
        raise error

    def request_in(self, data, is_over):
        """The path and the body, or None where they have not arrived."""
        end = re.search(rb"\r?\n\r?\n", data[: self.most_head])
        if not end:
            if len(data) > self.most_head:
                raise Refusal("InvalidInput", f"the head has more than {self.most_head} bytes", 431)
            return None
        first, *lines = data[: end.start()].decode("latin-1").split("\n")
        method, path, *_ = [*first.split(), "", ""]
        verbs = {"GET": ("Info",), "POST": ("InputSizes", "OutputSizes", "ModelInfo", *Served.VERBS)}
        if path[:1] != "/" or path[1:] not in verbs.get(method, ()):
            raise Refusal("InvalidInput", "UM-Bridge has no such path with this HTTP method", 404)
        heads = {name.strip().lower(): value.strip() for name, _, value in (line.partition(":") for line in lines)}
        if not self.is_own_host(heads.get("host", "")):
            raise Refusal("InvalidInput", "Host must be the address of this server", 403)
        length = heads.get("content-length", "0")
        is_known = re.fullmatch("[0-9]{1,15}", length) and int(length) <= self.most_bytes
        if not is_known or "chunked" in heads.get("transfer-encoding", ""):
            raise Refusal("InvalidInput", f"the body must have a Content-Length of at most {self.most_bytes} bytes", 413)
        arrived = len(data) - end.end()
        if arrived >= int(length):
            return path[1:], bytes(data[end.end() : end.end() + int(length)])
        if is_over:
            raise Refusal("InvalidInput", f"{arrived} of {length} bytes arrived within {self.patience} s", 408)
        return None

    def is_own_host(self, host):
        """Whether it is an address. A page of another site would name its own domain."""
        name = host
        try:
            name = urllib.parse.urlsplit("//" + host).hostname or ""
            return bool(ipaddress.ip_address(name))
        except ValueError:
            return name in ("localhost", self.host)

    def handle(self, connection, make):
        """Sends what make() returns, or why it returns nothing."""
        status = 200
        try:
            answer = make()
        except Refusal as refusal:
            status, answer = refusal.status, {"error": {"type": refusal.kind, "message": str(refusal)}}
        except isoline.Stop:
            status, answer = 400, {"error": {"type": "InvalidInput", "message": "the run is over: its "
                                             "target is reached or its budget is spent"}}
            self.served.is_over = True
        except (isoline.Refused, OverflowError, ValueError, TypeError) as error:
            status, answer = 400, {"error": {"type": "InvalidInput", "message": str(error)[:500]}}
        if callable(answer):
            self.begun += 1
            self.calls.put((connection, answer))
            return
        body = json.dumps(answer).encode()
        text = (f"HTTP/1.0 {status} {http.client.responses[status]}\r\nContent-Type: application/json\r\n"
                f"Content-Length: {len(body)}\r\n\r\n").encode() + body
        try:
            sent = connection.send(text)
        except OSError:  # the client is gone
            sent = len(text)
        if sent < len(text):  # others do not wait for a client that reads slowly
            threading.Thread(target=self.send, args=(connection, text[sent:]), daemon=True).start()
        else:
            connection.close()

    def send(self, connection, text):
        with connection, contextlib.suppress(OSError):
            connection.settimeout(self.patience)
            connection.sendall(text)


def serve(given):
    offers = [] if given.offers == "none" else given.offers.split(",")
    run = isoline.optimizer(needs=offers, name=given.client,
                            note="A method in another program, over UM-Bridge.",
                            source="Seelinger et al. (2023), protocol 1.0")
    served = Served(run, offers)
    door = Door(served, given.host, given.port)
    while not served.is_over:
        door.listen(0.05)
        patience = given.idle if served.best_loss < math.inf else given.startup
        if door.done == door.begun and time.monotonic() - served.called > patience:
            break
    if served.is_over:
        door.calls.put(None)
        door.worker.join(1)  # others wait for their answers, too
        raise isoline.Stop
    run.finish(served.best, f"no call arrived for {given.idle:g} s")


def main():
    parser = argparse.ArgumentParser(prog="umbridge", description=__doc__.split("\n", 1)[0])
    roles = parser.add_subparsers(dest="role", required=True)
    one = roles.add_parser("model", help="use the model of a server as a problem")
    one.add_argument("--url", default="", help="address of a running server")
    one.add_argument("--model", default="", help="name of the model; not needed if the server has only one")
    one.add_argument("--config", default="{}", help="JSON object passed with each call")
    one.add_argument("--option", type=entry, action="append", default=[], metavar="NAME=VALUE",
                     help="an entry of config that is an option of the problem, and its default")
    one.add_argument("--start", type=vector, required=True, help="x0: \"[1,2]\" or a .npy file")
    one.add_argument("--target", type=vector, required=True, help="y*")
    one.add_argument("--truth", type=vector, help="x*, if known")
    one.add_argument("--minimum", type=float, help="least attainable loss, if known; without it, only --aim x can be solved")
    one.add_argument("--differences", action="store_true",
                     help="derivatives by central differences, for a model that only evaluates")
    one.add_argument("--aim", choices=["loss", "x"], help="x: the success criterion is the error in x, not the loss")
    one.add_argument("--start-scale", choices=["own"],
                     help="own: random starts have a standard deviation of a tenth of |x0| in each unknown")
    one.add_argument("--x-floor", type=float, help="smallest error in x that is attainable with noisy data")
    one.add_argument("--label", default="", help="name in tables")
    one.add_argument("--startup", type=float, default=30, help="seconds that the server may take to start listening")
    one.add_argument("command", nargs="*", help="command that starts a server on the port in PORT")
    two = roles.add_parser("serve", help="use a method in another program as an optimizer")
    two.add_argument("--port", type=int, required=True)
    two.add_argument("--host", default="127.0.0.1")
    two.add_argument("--client", default="client", help="name of the method in tables")
    two.add_argument("--offers", default="pullback",
                     help="derivatives that the server offers: pullback, pushforward, hessian_product, comma-separated; or none")
    two.add_argument("--idle", type=float, default=10, help="seconds without a call after which the run ends")
    two.add_argument("--startup", type=float, default=50, help="seconds to wait for the first call")
    given = parser.parse_args()
    if given.role == "serve":
        serve(given)
    elif bool(given.url) == bool(given.command):
        parser.error("model needs either --url ADDRESS, or -- COMMAND that starts a server")
    else:
        try:
            model(given)
        except (RuntimeError, ValueError, KeyError, TypeError, OSError) as error:
            sys.exit(f"umbridge: {error}")


if __name__ == "__main__":
    main()
