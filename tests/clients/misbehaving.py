"""Programs that violate the protocol, one per argument, to test the adapter of child processes."""

import os
import struct
import sys
import time

mode = sys.argv[1]
if mode == "dies-at-import":
    import a_package_that_nobody_has  # noqa: F401
if mode == "is-late":
    time.sleep(60)
if mode == "is-silent":
    os._exit(0)
if mode == "floods-at-once":
    for _ in range(1000):
        os.write(1, b"x" * 10**6)

import isoline

calls = 0
state = [0.0]


def head(verb, status, count):
    return struct.pack("<IIQ", verb, status, count)


def misbehave(x):
    line = isoline._greeted()[0].socket
    if mode == "floods":
        for _ in range(1000):
            os.write(1, b"x" * 10**6)
    elif mode == "closes":
        line.close()
        time.sleep(60)
    elif mode == "leaves":
        print("I have had enough", flush=True)
        os._exit(3)
    elif mode == "half-a-frame":
        line.sendall(head(2, 0, 16) + bytes(8))
        os._exit(0)
    elif mode == "a-huge-frame":
        line.sendall(head(2, 0, 1 << 63) + bytes(8))
    elif mode == "a-huge-complaint":
        line.sendall(head(2, 1, 1 << 63) + bytes(8))
    elif mode == "another-verb":
        line.sendall(head(99, 0, 16) + bytes(16))
    elif mode == "two-answers":
        line.sendall(2 * (head(2, 0, 16) + bytes(16)))
    elif mode in ("raises", "always-raises"):
        raise ValueError("the mesh is tangled")
    elif mode == "raises-at-length":
        raise ValueError("the mesh is tangled" + "\ud800" + 100_000 * "x")
    elif mode == "is-killed":
        os.kill(os.getpid(), 9)
    elif mode == "hangs":
        time.sleep(600)
    elif mode == "forks":
        ready, written = os.pipe()
        if os.fork() == 0:
            os.setsid()
            with open(sys.argv[2].removeprefix("file="), "w") as file:
                file.write(str(os.getpid()))
            os.write(written, b".")
            time.sleep(600)
        os.read(ready, 1)


def forward(x):
    global calls
    calls += 1
    if calls == 3 or (mode == "always-raises" and calls > 1):  # after the handshake and a check
        misbehave(x)
    if mode == "is-random":
        state[0] += 1e-9
    if mode == "is-not-finite" and x[0] < -0.5:
        return [float("nan"), float("inf")]
    if mode == "returns-nothing":
        return None
    if mode == "returns-text":
        return ["1", "2"]
    if mode == "edits-itself" and calls == 3:
        with open(__file__, "a") as file:
            file.write("#")
    if mode == "changes-its-argument":
        a, b = x
        x[0] = x[1] = 0.0
        return [10 * (b - a * a), 1 - a]
    return [10 * (x[1] - x[0] * x[0]) + state[0], 1 - x[0]]


def jacobian(x):
    sign = -1 if mode == "has-a-wrong-sign" else 1
    return [[-20 * sign * x[0], 10], [-1, 0]]


minimum = float("nan") if mode == "has-no-finite-minimum" else 0.0
isoline.problem(forward, [1.2, 1], minimum=minimum, jacobian=jacobian, name=mode)
