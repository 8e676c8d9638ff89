"""Requests that no good client makes: each gets an error object or a closed connection, the server
lives on and its memory stays small."""

import json
import random
import socket
import sys
import threading
import time
import unittest

import served

GOOD = {"name": "rosenbrock", "input": [[0.5, 0.5]], "config": {}}
MOST_MEGABYTES = 300  # of the server, whose own libraries take some hundred


def resident_megabytes(pid):
    with open(f"/proc/{pid}/status", encoding="ascii") as status:
        for line in status:
            if line.startswith("VmHWM"):
                return int(line.split()[1]) / 1024
    raise RuntimeError("no VmHWM")


def listener_of(port):
    """The process that listens there."""
    import glob
    import os
    port = f"{int(port):04X}"
    with open("/proc/net/tcp", encoding="ascii") as table:
        inodes = {line.split()[9] for line in table if line.split()[1].endswith(":" + port)
                  and line.split()[3] == "0A"}
    for link in glob.glob("/proc/[0-9]*/fd/*"):
        try:
            if any(os.readlink(link) == f"socket:[{inode}]" for inode in inodes):
                return int(link.split("/")[2])
        except OSError:
            continue
    raise RuntimeError("nobody listens")


class Hostile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.models = cls.enterClassContext(served.serving(sys.argv[1], "rosenbrock"))

    def setUp(self):
        self.pid = listener_of(self.models.port)

    def tearDown(self):
        """It still answers, and has not grown."""
        self.assertEqual(served.Models(self.models.url).evaluate("rosenbrock", [[1.0, 1.0]]),
                         [[0.0, 0.0]])
        self.assertLess(resident_megabytes(self.pid), MOST_MEGABYTES)

    def assert_refused(self, body, path="/Evaluate", method="POST"):
        status, text = served.Models(self.models.url).raw(method, path, body)
        self.assertIn(status, (400, 404, 413, 500), text[:200])
        error = json.loads(text)["error"]
        self.assertIn(error["type"], ("ModelNotFound", "UnsupportedFeature", "InvalidInput",
                                      "InvalidOutput"))
        self.assertLess(len(text), 1000, "an error does not repeat what it was given")

    def connected(self):
        return self.enterContext(socket.create_connection(
            (self.models.host, int(self.models.port)), timeout=served.PATIENCE))

    def test_types(self):
        for value in [None, True, 3, "x", [], {}, [[]], [[[1, 2]]], [["a", "b"]], [{"a": 1}],
                      [[1, None, 3]], [[True, False]]]:
            for key in GOOD:
                if (key, value) == ("config", {}) or (key == "name" and value == "rosenbrock"):
                    continue
                self.assert_refused(json.dumps(GOOD | {key: value}))

    def test_bodies_that_are_no_json(self):
        for body in [b"", b"{", b"\0" * 1000, b"\xff\xfe" * 50, b"nan", b'{"name": "rosenbrock"',
                     b'{"name": "rosenbrock", "input": [[1e999, 1]]}', b"[" * 1000, b"{}" * 1000,
                     b'{"name": "\\ud800"}']:
            self.assert_refused(body)

    def test_depth(self):
        for opening, closing in [("[", "]"), ('{"a":', "}")]:
            for depth in (100, 10_000, 150_000):
                self.assert_refused('{"name": "rosenbrock", "input": ' + opening * depth + "1" +
                                    closing * depth + "}")

    def test_sizes(self):
        for count in (0, 1, 3, 10_000):
            self.assert_refused(json.dumps(GOOD | {"input": [[1.0] * count]}))
            self.assert_refused(json.dumps(GOOD | {"input": [[1.0, 1.0]] * (count if count != 1
                                                                            else 2)}))

    def test_paths_and_methods(self):
        for method in ("PUT", "DELETE", "PATCH", "OPTIONS", "GET", "TRACE"):
            self.assert_refused(None, method=method)
        for path in ("/", "/evaluate", "/Evaluate/", "/../etc/passwd", "/" + "a" * 8000,
                     "/EvaluateShMem"):
            self.assert_refused(json.dumps(GOOD), path=path)

    def test_a_gigabyte_is_refused_without_room_for_it(self):
        chunk = b" " * (1 << 20)
        caller = self.connected()
        caller.sendall(b"POST /Evaluate HTTP/1.1\r\nHost: x\r\nContent-Length: %d\r\n\r\n"
                       % (1 << 30))
        try:
            for _ in range(1 << 10):
                caller.sendall(chunk)
        except OSError:  # it need not listen to the end
            pass
        self.assertIn(b"413", caller.recv(4096)[:20])

    def test_a_gigabyte_in_chunks_is_refused_without_room_for_it(self):
        chunk = b"100000\r\n" + b" " * (1 << 20) + b"\r\n"
        caller = self.connected()
        caller.sendall(b"POST /Evaluate HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n")
        try:
            for _ in range(1 << 10):
                caller.sendall(chunk)
        except OSError:
            return
        self.assertEqual(caller.recv(4096)[:12], b"HTTP/1.1 413")

    def test_a_head_without_an_end_is_given_up(self):
        caller = self.connected()
        try:
            caller.sendall(b"POST /Evaluate HTTP/1.1\r\n")
            for _ in range(1 << 12):
                caller.sendall(b"X-Another: " + b"y" * 1000 + b"\r\n")
            answer = caller.recv(4096)
        except OSError:  # it need not listen to the end
            return
        self.assertEqual(answer[:10], b"HTTP/1.1 4")

    def test_silent_callers_do_not_lock_others_out_for_long(self):
        silent = [self.connected() for _ in range(8)]
        for caller in silent:
            caller.sendall(b"POST /Evaluate HTTP/1.1\r\nContent-Length: 100\r\n\r\n{")
        begun = time.monotonic()
        self.models.evaluate("rosenbrock", [[1.0, 1.0]])
        self.assertLess(time.monotonic() - begun, 30)

    def test_random_bytes(self):
        draw = random.Random(1)
        good = json.dumps(GOOD).encode()
        for _ in range(300):
            body = bytearray(good)
            for _ in range(draw.randrange(1, 6)):
                body[draw.randrange(len(body))] = draw.randrange(256)
            status, text = served.Models(self.models.url).raw("POST", "/Evaluate", bytes(body))
            self.assertIn(status, (200, 400))
            json.loads(text)

    def test_many_at_once(self):
        failures = []

        def ask():
            models = served.Models(self.models.url)
            for i in range(50):
                if models.evaluate("rosenbrock", [[float(i), 0.0]])[0][1] != 1.0 - i:
                    failures.append(i)

        threads = [threading.Thread(target=ask) for _ in range(12)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
