"""A program that serves UM-Bridge, started and stopped, and a client of the protocol in Python's
standard library that knows nothing of Isoline."""

import contextlib
import http.client
import json
import os
import re
import signal
import subprocess

PATIENCE = 60  # seconds that a busy machine may take


class Models:
    """A client of one server, over one connection that is kept."""

    def __init__(self, url):
        self.host, self.port = re.fullmatch(r"http://([^:/]+):(\d+)", url).groups()
        self.url = url
        self.connection = http.client.HTTPConnection(self.host, int(self.port), timeout=PATIENCE)

    def raw(self, method, path, body=None, headers=None):
        """The status and the text of an answer."""
        self.connection.request(method, path, body, headers or {})
        answer = self.connection.getresponse()
        return answer.status, answer.read().decode("utf-8")

    def ask(self, path, **members):
        status, text = self.raw("POST", path, json.dumps(members))
        return status, json.loads(text)

    def info(self):
        status, text = self.raw("GET", "/Info")
        assert status == 200, text
        return json.loads(text)

    def evaluate(self, name, parts):
        status, answer = self.ask("/Evaluate", name=name, input=parts, config={})
        if status != 200:
            raise RuntimeError(answer["error"]["message"])
        return answer["output"]

    def gradient(self, name, parts, sens):
        status, answer = self.ask("/Gradient", name=name, input=parts, inWrt=0, outWrt=0, sens=sens,
                                  config={})
        if status != 200:
            raise RuntimeError(answer["error"]["message"])
        return answer["output"]


@contextlib.contextmanager
def serving(program, *arguments, cwd=None, said=None):
    """Models of `isoline serve ...`, which is ended politely; what it says then goes to `said`."""
    process = subprocess.Popen([program, "serve", *arguments], stdout=subprocess.PIPE, text=True,
                               cwd=cwd, env=dict(os.environ, PORT=""))
    try:
        line = process.stdout.readline()
        found = re.search(r"http://\S+$", line.strip())
        assert found, f"no address: {line!r}, {process.poll()}"
        models = Models(found.group())
        yield models
        models.connection.close()
        process.send_signal(signal.SIGTERM)
        rest, _ = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0, process.returncode
        if said is not None:
            said.append(line + rest)
    finally:
        process.kill()
        process.communicate()
