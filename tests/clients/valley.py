"""Rosenbrock's valley with the arithmetic of the compiled one: `fused` rounds a − b c once."""

import sys
from fractions import Fraction

import isoline

is_fused = sys.argv[1] == "fused"


def product_added(a, b, c):  # a + b c
    return float(Fraction(a) + Fraction(b) * Fraction(c)) if is_fused else a + b * c


def forward(x):
    return [10 * product_added(x[1], -x[0], x[0]), 1 - x[0]]


def jacobian(x):
    return [[-20 * x[0], 10], [-1, 0]]


def inverse(y, x0):
    x = 1 - y[1]
    return [x, product_added(y[0] / 10, x, x)]


isoline.problem(
    forward, [-1.2, 1], target=[0, 0], truth=[1, 1], minimum=0.0, jacobian=jacobian,
    inverse=inverse, name="valley",
)
