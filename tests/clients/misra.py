"""NIST's regression Misra1a: exact, wrong by 0.1 % in an element of J, or by differences."""

import math
import sys

import isoline

kind, *own = sys.argv[1:]
times = [77.6 + 52.5 * i for i in range(14)]
factor = 1.001 if kind == "wrong" else 1


def forward(b):
    return [b[0] * (1 - math.exp(-b[1] * t)) for t in times]


def jacobian(b):
    return [[1 - math.exp(-b[1] * t), factor * b[0] * t * math.exp(-b[1] * t)] for t in times]


isoline.problem(forward, [500, 1e-4], truth=[238.94, 5.5e-4], start_scale="own" if own else None,
                **({"differences": True} if kind == "differences" else {"jacobian": jacobian}))
