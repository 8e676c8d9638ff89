"""Optimizers that violate the protocol, one per argument."""

import sys

import isoline

mode = sys.argv[1]
p = isoline.optimizer(["pullback"], mode, reports=True)
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
elif mode == "talks":
    p.report(p.x0)
    print("what I think of it")
    p.finish([0.5 * x for x in p.x0], "a small loss, I believe")
