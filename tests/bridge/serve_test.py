"""A problem of Isoline that a method elsewhere asks over UM-Bridge: what the protocol asks of a server,
requests that no good client makes, and the record that comes of it."""

import contextlib
import glob
import http.client
import json
import os
import pathlib
import random
import socket
import subprocess
import sys
import tempfile
import time
import unittest

VERBS = ["Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian"]
PATIENCE = 60
GOOD = {"name": "loss", "input": [[0.5, 0.5]], "config": {}}


def free_port():
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


class Caller:
    """A client in the standard library."""

    def __init__(self, port):
        self.port = port

    def raw(self, method, path, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        connection.request(method, path, body)
        reply = connection.getresponse()
        text = reply.read().decode()
        connection.close()
        return reply.status, text

    def ask(self, verb, **members):
        status, text = self.raw("POST", f"/{verb}", json.dumps(members))
        return status, json.loads(text)

    def output(self, verb, **members):
        status, answer = self.ask(verb, **members)
        assert status == 200, answer
        return answer["output"]


@contextlib.contextmanager
def serving(folder, problem, *more, offers="pullback,pushforward,hessian_product", code=0):
    """`isoline run` of the problem with a method that is elsewhere."""
    port = free_port()
    command = (f"{sys.executable} -m umbridge serve --port {port} --client my-descent --idle 1 "
               f"--offers {offers}")
    run = subprocess.Popen([sys.argv[1], "run", "--problem", problem, "--optimizer",
                            f'process[command="{command}"]', "--out", "mine", "--no-report",
                            "--rates", "none", *more], cwd=folder, stdout=subprocess.PIPE,
                           stderr=subprocess.STDOUT, text=True)
    caller = Caller(port)
    deadline = time.monotonic() + PATIENCE
    while True:
        try:
            caller.raw("GET", "/Info")
            break
        except OSError:
            assert run.poll() is None and time.monotonic() < deadline, run.communicate()[0]
            time.sleep(0.05)
    try:
        yield caller
        said = run.communicate(timeout=PATIENCE)[0]
        assert run.returncode == code, said
    finally:
        run.kill()
        run.communicate()


def is_error(answer, kind):
    error = answer.get("error", {})
    return set(error) == {"type", "message"} and error["type"] == kind and error["message"]


class Served(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())

    def record(self):
        (path,) = glob.glob(f"{self.folder}/mine/runs/*.json")
        return json.loads(pathlib.Path(path).read_text(encoding="utf-8"))

    def isoline(self, *arguments):
        run = subprocess.run([sys.argv[1], *arguments], cwd=self.folder, capture_output=True,
                             text=True, check=False, timeout=300)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run.stdout

    def descend(self, caller, steps):
        (x,) = caller.output("Evaluate", name="start", input=[])
        for _ in range(steps):
            slope = caller.output("Gradient", name="loss", input=[x], outWrt=0, inWrt=0, sens=[1.0])
            x = [x[i] - 0.02 * slope[i] for i in range(len(x))]
            caller.output("Evaluate", name="loss", input=[x])

    def test_sizes_types_and_errors_of_the_protocol(self):
        with serving(self.folder, "rosenbrock") as caller:
            info = json.loads(caller.raw("GET", "/Info")[1])
            self.assertEqual(info, {"protocolVersion": 1.0, "models": ["loss", "residual", "start"]})
            for name, inputs, outputs in [("loss", [2], [1]), ("residual", [2], [2]), ("start", [], [2])]:
                with self.subTest(model=name):
                    self.assertEqual(caller.ask("InputSizes", name=name)[1]["inputSizes"], inputs)
                    self.assertEqual(caller.ask("OutputSizes", name=name)[1]["outputSizes"], outputs)
                    support = caller.ask("ModelInfo", name=name)[1]["support"]
                    self.assertEqual(sorted(support), sorted(VERBS))
                    call = {"name": name, "input": [[0.5] * size for size in inputs], "outWrt": 0,
                            "inWrt": 0, "inWrt1": 0, "inWrt2": 0, "sens": [1.0] * outputs[0],
                            "vec": [1.0] * sum(inputs)}
                    for verb in VERBS:
                        status, answer = caller.ask(verb, **call)
                        if not support[verb]:
                            self.assertTrue(is_error(answer, "UnsupportedFeature"), answer)
                            continue
                        self.assertEqual(status, 200, answer)
                        for wrong in [{"input": call["input"] + [[1.0]]}, {"outWrt": 1}, {"sens": []},
                                      {"vec": [1.0] * 7}]:
                            (key,) = wrong
                            if verb == "Evaluate" and key != "input" or name == "start" or (
                                    key == "vec" and verb == "Gradient") or (
                                    key == "sens" and verb == "ApplyJacobian"):
                                continue
                            status, answer = caller.ask(verb, **{**call, **wrong})
                            self.assertTrue(is_error(answer, "InvalidInput"), (verb, wrong, answer))
            for path in ["InputSizes", "OutputSizes", "ModelInfo", *VERBS]:
                status, answer = caller.ask(path, name="wrong_model_name")
                self.assertEqual(status, 400)
                self.assertTrue(is_error(answer, "ModelNotFound"), answer)
            x = [0.5, 0.25]
            r = caller.output("Evaluate", name="residual", input=[x])[0]
            self.assertEqual(r, [10 * (x[1] - x[0] ** 2), 1 - x[0]])
            self.assertAlmostEqual(caller.output("Evaluate", name="loss", input=[x])[0][0],
                                   sum(each * each for each in r) / 2)
            back = caller.output("Gradient", name="residual", input=[x], sens=[1.0, 2.0])
            ahead = caller.output("ApplyJacobian", name="residual", input=[x], vec=[3.0, 4.0])
            self.assertAlmostEqual(3 * back[0] + 4 * back[1], ahead[0] + 2 * ahead[1])

    def test_a_name_of_another_site_is_refused(self):
        with serving(self.folder, "rosenbrock") as caller:
            for host, expected in [("evil.example", 403), ("localhost:80", 200), ("[::1]:80", 200), ("", 403)]:
                connection = http.client.HTTPConnection("127.0.0.1", caller.port, timeout=PATIENCE)
                connection.request("GET", "/Info", headers={"Host": host})
                self.assertEqual(connection.getresponse().status, expected, host)
                connection.close()
            caller.output("Evaluate", **GOOD)

    def test_requests_that_no_good_client_makes(self):
        draw = random.Random(1)
        good = json.dumps(GOOD).encode()
        bodies = [b"", b"{", b"\0" * 1000, b"\xff\xfe" * 50, b"nan", b"[" * 100_000, b"5", b"[]"]
        for key in GOOD:
            bodies += [json.dumps({**GOOD, key: value}).encode()
                       for value in [None, True, 3, [[]], [["a", "b"]], [[1, None]], [[True, False]]]]
        for _ in range(100):
            body = bytearray(good)
            for _ in range(draw.randrange(1, 6)):
                body[draw.randrange(len(body))] = draw.randrange(256)
            bodies.append(bytes(body))
        with serving(self.folder, "rosenbrock", code=0) as caller:
            for body in bodies:
                status, text = caller.raw("POST", "/Evaluate", body)
                self.assertIn(status, (200, 400), text)
                json.loads(text)
                self.assertLess(len(text), 1000, "an error does not repeat its input")
            for method, path in [("PUT", "/Evaluate"), ("GET", "/Evaluate"), ("POST", "/evaluate"),
                                 ("POST", "/../etc/passwd"), ("POST", "/" + "a" * 8000)]:
                self.assertEqual(caller.raw(method, path, good)[0], 404, path)
            with socket.create_connection(("127.0.0.1", caller.port), timeout=PATIENCE) as silent, \
                    socket.create_connection(("127.0.0.1", caller.port), timeout=PATIENCE) as large:
                silent.sendall(b"POST /Evaluate HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\n\r\n{")
                large.sendall(b"POST /Evaluate HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: %d\r\n\r\n" % (1 << 30))
                self.assertIn(b" 413 ", large.recv(4096)[:20])
                self.assertEqual(caller.ask("Evaluate", **GOOD)[0], 200)

    def test_what_was_asked_is_a_record_as_of_the_trees_own_method(self):
        with serving(self.folder, "square") as caller:
            self.descend(caller, 20)
        record = self.record()
        self.assertEqual(record["foreign"]["optimizer"]["label"], "my-descent")
        self.assertEqual((record["counts"]["forward"], record["counts"]["pullback"]), (21, 20))
        self.assertEqual(record["privileges"], [])
        self.isoline("validate", "mine")
        self.isoline("run", "--problem", "square", "--optimizer", "gd[rate=0.02]", "--iterations",
                     "20", "--target", "0", "--out", "own", "--no-report")
        (path,) = glob.glob(f"{self.folder}/own/runs/*.json")
        own = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        for key in ["minimum", "scale", "x_scale", "verified", "found"]:
            self.assertEqual(record.get(key), own.get(key), key)
        self.assertAlmostEqual(record["summary"]["loss"], own["summary"]["loss"])
        said = self.isoline("report", "own", "mine", "--out", "both")
        self.assertIn("my-descent", said)
        self.assertTrue(os.path.exists(f"{self.folder}/both/index.html"))

    def test_the_run_ends_at_its_budget(self):
        with serving(self.folder, "square", "--iterations", "5") as caller:
            with self.assertRaises((AssertionError, OSError, http.client.HTTPException)):
                self.descend(caller, 20)
        self.assertEqual(self.record()["status"], "budget")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
