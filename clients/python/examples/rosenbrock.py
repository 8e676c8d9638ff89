"""Rosenbrock's valley, without any package: a problem needs only a function of numbers."""
import isoline


def forward(x):
    return [10 * (x[1] - x[0] * x[0]), 1 - x[0]]


def jacobian(x):
    return [[-20 * x[0], 10], [-1, 0]]


def inverse(y, x0):
    x = 1 - y[1]
    return [x, y[0] / 10 + x * x]


isoline.problem(
    forward, [-1.2, 1], target=[0, 0], truth=[1, 1], minimum=0.0, jacobian=jacobian,
    inverse=inverse, name="rosenbrock-python",
)
