"""Optimizers that violate the protocol or barely use it, one per argument."""

import sys

import isoline

mode = sys.argv[1]
p = isoline.optimizer(["pullback"], mode, reports=True, keeps_bounds="bounds" in mode)
if mode == "asks-what-it-did-not-declare":
    p.jacobian(p.x0)
elif mode == "never-stops":
    while True:
        try:
            p.value_and_grad(p.x0)
        except isoline.Stop:
            pass
elif mode == "raises":
    raise ValueError("the step is no number")
elif mode == "leaves":
    sys.exit(4)
elif mode == "forgets":
    p.value(p.x0)
elif mode == "descends-within-bounds":
    x = list(p.x0)
    while True:
        ahead = (a - 0.5 * b for a, b in zip(x, p.gradient(x)))
        x = [min(max(a, low), high) for a, low, high in zip(ahead, p.lower, p.upper)]
        p.report(x)
elif mode == "leaves-its-bounds":
    x = list(p.x0)
    p.value(x)
    x[3] = p.upper[3] + 1
    p.value(x)
elif mode == "finishes-outside-its-bounds":
    p.finish([low - 1 for low in p.lower])
elif mode == "talks":
    p.report(p.x0)
    print("what I think of it")
    p.finish([0.5 * x for x in p.x0], "a small loss, I believe")
