"""NIST's regression Misra1a: exact, wrong by 0.1 % in an element of J, or by differences.

A second word gives the unknowns scales of their own, or bounds near the start ("box"); or three digits to y ("rounded").
"""

import math
import sys

import isoline

kind, *own = sys.argv[1:]
times = [77.6 + 52.5 * i for i in range(14)]
factor = 1.001 if kind == "wrong" else 1


def forward(b):
    y = [b[0] * (1 - math.exp(-b[1] * t)) for t in times]
    return [float("%.3g" % each) for each in y] if own == ["rounded"] else y


def jacobian(b):
    return [[1 - math.exp(-b[1] * t), factor * b[0] * t * math.exp(-b[1] * t)] for t in times]


truth = [238.94, 5.5e-4]
box = [[b * (1 + share) for b in truth] for share in (-1e-5, 1e-5)] if own == ["box"] else None
isoline.problem(forward, truth if box else [500, 1e-4], truth=truth, bounds=box, start_scale="own" if own else None,
                **({"differences": True} if kind == "differences" else {"jacobian": jacobian}))
