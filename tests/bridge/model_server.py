"""A server of UM-Bridge in Python's standard library, which listens at PORT: Rosenbrock's valley,
whose factor 10 is the entry "height" of config, and the same with what other servers do, by the word that it is started with:

  plain     one input, one output
  fused     the same where a processor fuses products with sums: x2 - x1² is rounded once
  parts     each unknown and each residual a vector of its own
  forward   Evaluate alone
  holes     what is not finite is NaN, null or Infinity; x1 < -1.15 has no value
  chatty    a megabyte on standard output at each call
  late      listens after a second
  broken    dies before it listens
  short     gives one number where two are promised
  mortal    ends at its fortieth Evaluate
  refusing  answers Evaluate by an error
"""

import fractions
import http.server
import json
import os
import sys
import time

KIND = sys.argv[1] if len(sys.argv) > 1 else "plain"
PARTS = KIND == "parts"
asked_so_far = 0


def residuals(x, height=10):
    if KIND == "fused":
        return [10 * float(fractions.Fraction(x[1]) - fractions.Fraction(x[0]) ** 2), 1 - x[0]]
    return [height * (x[1] - x[0] * x[0]), 1 - x[0]]


def jacobian(x, height=10):
    return [[-2 * height * x[0], height], [-1.0, 0.0]]


def joined(parts):
    return [value for part in parts for value in part]


def split(values):
    return [[value] for value in values] if PARTS else [values]


class Answers(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # head and body are two packets

    def do_GET(self):
        self.give({"protocolVersion": 1.0, "models": ["valley"]})

    def do_POST(self):
        asked = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        if asked["name"] != "valley":
            self.give({"error": {"type": "ModelNotFound", "message": "no such model"}}, 400)
            return
        self.give(*getattr(self, self.path[1:])(asked))

    def InputSizes(self, _):
        return ({"inputSizes": [1, 1] if PARTS else [2]},)

    OutputSizes = lambda self, _: ({"outputSizes": [1, 1] if PARTS else [2]},)

    def ModelInfo(self, _):
        more = KIND != "forward"
        return ({"support": {"Evaluate": True, "Gradient": more, "ApplyJacobian": more}},)

    def Evaluate(self, asked):
        x = joined(asked["input"])
        if KIND == "refusing":
            return {"error": {"type": "InvalidOutput", "message": "the mesh is tangled"}}, 500
        global asked_so_far
        asked_so_far += 1
        if KIND == "mortal" and asked_so_far >= 40:
            os._exit(3)
        if KIND == "chatty":
            print("x" * (1 << 20))
        y = residuals(x, asked["config"].get("height", 10))
        if KIND == "holes" and x[0] < -1.15:
            y = [float("nan"), None]
        return ({"output": split(y[:1] if KIND == "short" else y)},)

    def Gradient(self, asked):
        J = jacobian(joined(asked["input"]), asked["config"].get("height", 10))
        if PARTS:
            return ({"output": [J[asked["outWrt"]][asked["inWrt"]] * asked["sens"][0]]},)
        return ({"output": [sum(J[i][j] * asked["sens"][i] for i in range(2)) for j in range(2)]},)

    def ApplyJacobian(self, asked):
        J = jacobian(joined(asked["input"]), asked["config"].get("height", 10))
        if PARTS:
            return ({"output": [J[asked["outWrt"]][asked["inWrt"]] * asked["vec"][0]]},)
        return ({"output": [sum(J[i][j] * asked["vec"][j] for j in range(2)) for i in range(2)]},)

    def give(self, answer, status=200):
        text = json.dumps(answer).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)

    def log_message(self, *_):
        pass


if KIND == "broken":
    raise ImportError("no module named meshing")
if KIND == "late":
    time.sleep(1)
http.server.ThreadingHTTPServer(("127.0.0.1", int(os.environ["PORT"])), Answers).serve_forever()
