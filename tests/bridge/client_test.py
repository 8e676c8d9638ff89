"""Problems behind UM-Bridge, as `isoline run` treats them: a server that knows nothing of Isoline is
started for each cell, is certified, run and ended with it."""

import glob
import http.server
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "clients" / "python"))
import umbridge  # noqa: E402

SERVER = pathlib.Path(__file__).parent / "model_server.py"
GIVEN = "--start [-1.2,1] --target [0,0] --truth [1,1] --minimum 0"


def spec(kind, given=GIVEN, server=SERVER):
    command = f"{sys.executable} -m umbridge model {given} -- {sys.executable} {server} {kind}"
    return f'process[command="{command}"]'


def processes_with(word):
    found = []
    for path in glob.glob("/proc/[0-9]*/cmdline"):
        try:
            with open(path, "rb") as command:
                if word.encode() in command.read().split(b"\0"):
                    found.append(path)
        except OSError:
            continue
    return found


class Client(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())

    def isoline(self, *arguments, code=0):
        run = subprocess.run([sys.argv[1], *arguments], cwd=self.folder, capture_output=True,
                             text=True, check=False, timeout=300)
        self.assertEqual(run.returncode, code, run.stdout + run.stderr)
        return run.stdout + run.stderr

    def record(self, problem, optimizer):
        """At the method's own defaults: tuned rates are kept by a problem's name."""
        out = f"{len(os.listdir(self.folder))}"
        said = self.isoline("run", "--problem", problem, "--optimizer", optimizer, "--out", out,
                            "--no-report", "--rates", "none")
        found = glob.glob(f"{self.folder}/{out}/runs/*.json")
        self.assertEqual(len(found), 1, said)
        with open(found[0], encoding="utf-8") as file:
            return json.load(file)

    COLUMNS = ["iteration", "loss", "x_error", "gradient_norm", "step_norm"]

    def traced(self, record):
        return record["status"], record["counts"], [record["curve"][key] for key in self.COLUMNS]

    def test_the_same_trace_as_the_trees_own_bit_for_bit(self):
        """The compiler may have fused a product with a sum, and Python never does."""
        for optimizer in ["levenberg-marquardt", "gd[rate=1e-3]"]:
            own = self.traced(self.record("rosenbrock", optimizer))
            there = [self.traced(self.record(spec(kind), optimizer)) for kind in ["plain", "fused"]]
            self.assertIn(own, there, optimizer)

    def test_how_a_server_behaves_changes_nothing(self):
        plain = self.traced(self.record(spec("plain"), "levenberg-marquardt"))
        for kind in ["parts", "late", "chatty"]:
            there = self.traced(self.record(spec(kind), "levenberg-marquardt"))
            self.assertEqual(there, plain, kind)

    def test_a_record_names_the_server_and_a_changed_one_is_another_build(self):
        own = pathlib.Path(self.folder) / "server.py"
        own.write_text(SERVER.read_text(encoding="utf-8"), encoding="utf-8")
        problem = spec("plain", GIVEN + " --label valley", own)
        first = self.record(problem, "ceres-lm")
        foreign = first["foreign"]["problem"]
        self.assertEqual(foreign["door"], "process")
        self.assertEqual(foreign["label"], "valley")
        self.assertIn("server.py plain", foreign["command"])
        own.write_text(own.read_text(encoding="utf-8") + "# a remark\n", encoding="utf-8")
        second = self.record(problem, "ceres-lm")
        self.assertEqual(second["cell"], first["cell"])
        self.assertNotEqual(second["build_parts"]["problem"], first["build_parts"]["problem"])
        self.assertEqual(second["curve"]["loss"], first["curve"]["loss"])

    def test_what_is_offered_passes_its_certificate(self):
        said = self.isoline("check", spec("parts"))
        self.assertIn("0 failed", said)

    def test_forward_alone_is_for_methods_without_derivatives(self):
        self.assertEqual(self.record(spec("forward"), "adam")["status"], "inapplicable")
        by_differences = GIVEN + " --differences --aim x --start-scale own"
        found = self.record(spec("forward", by_differences), "levenberg-marquardt")
        self.assertTrue(found["found"]["1e-6"], found["message"])
        self.assertGreater(found["prices"]["pullback"], 1)
        found = self.record(spec("forward"), "nlopt-neldermead")
        self.assertLess(found["summary"]["loss"], 1e-6)

    def test_entries_of_config_are_options_that_are_swept_and_told_to_the_model(self):
        problem = spec("plain", GIVEN + " --label valley --option height=10 --option mesh=fine")
        said = self.isoline("run", "--problem", problem[:-1] + ",height=5|10]", "--optimizer",
                            "levenberg-marquardt", "--out", "swept")
        self.assertIn("valley[height=5]", said)
        losses = {}
        for path in glob.glob(f"{self.folder}/swept/runs/*.json"):
            with open(path, encoding="utf-8") as file:
                record = json.load(file)
            options = record["request"]["problem"]["options"]
            self.assertEqual(options["mesh"], "fine")
            losses[options["height"]] = record["summary"]["start_loss"]
        residual = 1 - 1.2 ** 2
        for height in (5, 10):
            self.assertAlmostEqual(losses[height], ((height * residual) ** 2 + 2.2 ** 2) / 2, 12)
        self.assertIn("unknown option", self.isoline("check", problem[:-1] + ",hight=5]", code=1).lower())
        self.assertIn("--option", self.isoline("check", spec("plain", GIVEN + " --option 5"), code=1))

    def test_what_is_not_finite_is_data(self):
        start = GIVEN.replace("-1.2", "-1.1")
        found = self.record(spec("holes", start), "nlopt-neldermead")
        self.assertIn(found["status"], ("target", "converged", "budget", "stalled"),
                      found["message"])

    def test_a_server_that_fails_is_refused_and_says_why(self):
        for kind, words in [("broken", "no module named meshing"), ("refusing", "mesh is tangled"),
                            ("short", "2 numbers")]:
            with self.subTest(kind=kind):
                self.assertIn(words, self.isoline("run", "--problem", spec(kind), "--optimizer",
                                                  "adam", "--out", kind, code=1))

    def test_a_server_that_dies_costs_a_call_and_the_record_says_why(self):
        self.isoline("run", "--problem", spec("mortal"), "--optimizer", "adam", "--out", "mortal",
                     "--no-report")
        (path,) = glob.glob(f"{self.folder}/mortal/runs/*.json")
        self.assertIn("ended with code 3", pathlib.Path(path).read_text(encoding="utf-8"))

    def test_what_is_given_wrong_is_refused_in_one_sentence(self):
        for given, words in [("--start [1] --target [0,0]", "2 numbers, got 1"),
                             (GIVEN + " --model other", "models, valley; got 'other'"),
                             (GIVEN + " --config 5", "--config must be")]:
            with self.subTest(given=given):
                self.assertIn(words, self.isoline("check", spec("plain", given), code=1))

    def test_no_server_outlives_its_cell(self):
        self.record(spec("plain"), "levenberg-marquardt")
        deadline = time.monotonic() + 30
        while processes_with(str(SERVER)) and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertEqual(processes_with(str(SERVER)), [])


class Options:
    """A socket that keeps what it was asked to set."""

    def __init__(self, inner):
        self.inner, self.told = inner, []

    def setsockopt(self, *given):
        self.told.append(given)
        self.inner.setsockopt(*given)

    def __getattr__(self, name):
        return getattr(self.inner, name)


class Answers(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"  # the connection stays open

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Length", "2")
        self.end_headers()
        self.wfile.write(b"{}")

    def log_message(self, *_):
        pass


class Connection(unittest.TestCase):
    @unittest.skipUnless(hasattr(socket, "TCP_QUICKACK"), "the system has no TCP_QUICKACK")
    def test_no_packet_waits_for_an_acknowledgement(self):
        server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Answers)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever, daemon=True).start()
        model = umbridge.Model.__new__(umbridge.Model)
        model.url, model.connection = f"http://127.0.0.1:{server.server_port}", None
        self.assertEqual(model.exchange("/Info", {}), (200, "{}"))
        kept = model.connection.sock
        self.addCleanup(kept.close)
        self.assertNotEqual(kept.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY), 0)
        model.connection.sock = Options(kept)
        model.exchange("/Info", {})
        self.assertIn((socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1), model.connection.sock.told,
                      "the same connection, for each request")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
