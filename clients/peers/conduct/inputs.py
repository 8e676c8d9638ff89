"""The inputs of the table of conduct, with a counter inside each callback.

line    1 + 2 t at t = 0 … 9, deviations fixed, σ = 0.1; from (0, 0)
E3      a exp(−b t) + c at t = 0, 0.25, …, 5; from (1, 1, 0)
E3s     E3 with b = 1e-6 q, from q = 1e6
RB      (10 (x2 − x1²), 1 − x1), from (−1.2, 1)
RBb     RB within −2 ≤ x1 ≤ 0.5, −2 ≤ x2 ≤ 2
QD      √i (x_i − 1), i = 1, 2, 3, from the solution
missing (log p, 0.1 (p − 1)) as residuals, p − log p as a loss; from 10, without a value for p ≤ 0
"""
import math
import zlib

import numpy

MOST_CALLS = 30_000
DEVIATIONS = (0.3, -1.1, 0.8, 0.1, -0.6, 1.4, -0.2, -0.9, 0.5, -0.3)


class Endless(BaseException):
    """More calls than any method needs."""


class Input:
    """A problem of either kind: r, or L = ½‖r‖² · factor, with their slopes and a log of all calls."""

    def __init__(self, start, residual, jacobian, bounds=None, factor=1.0, loss=None, slope=None, bits=0):
        self.start, self.bounds, self.factor = numpy.array(start, float), bounds, factor
        self.r = with_other_bits(residual, bits) if bits else residual
        self.J, self.own_loss, self.own_slope = jacobian, with_other_bits(loss, bits) if loss and bits else loss, slope
        self.calls = []  # (bits of x, loss)
        self.n, self.m = len(self.start), len(residual(self.start))

    def note(self, x, loss):
        self.calls.append((numpy.array(x, float).tobytes(), loss))
        if len(self.calls) > MOST_CALLS:
            raise Endless

    def residual(self, x):
        x = numpy.asarray(x, float)
        self.note(x, self.loss_at(x))
        return math.sqrt(self.factor) * self.r(x)

    def value(self, x):
        loss = self.loss_at(numpy.asarray(x, float))
        self.note(x, loss)
        return loss

    def loss_at(self, x):
        if self.own_loss:
            return self.factor * self.own_loss(x)
        r = self.r(x)
        with numpy.errstate(over="ignore", invalid="ignore"):  # a warning is no text of the library
            return 0.5 * self.factor * float(r @ r)

    def gradient(self, x):
        x = numpy.asarray(x, float)
        with numpy.errstate(over="ignore", invalid="ignore"):
            return self.factor * (self.own_slope(x) if self.own_slope else self.J(x).T @ self.r(x))

    def jacobian(self, x):
        return math.sqrt(self.factor) * self.J(numpy.asarray(x, float))

    def points(self):
        return [numpy.frombuffer(bits) for bits, _ in self.calls]


def with_other_bits(values, which):
    """The values, but for exact zeros, with other last bits, of numbers near 1, as another library of mathematics would
    have: fixed by x and `which`."""
    def other(x):
        r = values(x)
        digest = zlib.crc32(numpy.array(x, float).tobytes() + bytes([which]))
        return r + 2.0**-53 * (r != 0) * numpy.random.RandomState(digest).randint(-1, 2, numpy.shape(r))

    return other


def line(**more):
    t = numpy.arange(10.0)
    y = 1 + 2 * t + 0.1 * numpy.array(DEVIATIONS)
    return Input([0, 0], lambda x: (x[0] + x[1] * t - y) / 0.1, lambda x: numpy.stack([t**0, t], 1) / 0.1, **more)


def decay(unit=1.0, **more):
    """E3, and E3s with another unit of b."""
    t = numpy.arange(0, 5.01, 0.25)
    y = 2.5 * numpy.exp(-0.7 * t) + 0.5 + 0.05 * numpy.sin(7 * numpy.arange(len(t)))

    def residual(x):
        with numpy.errstate(over="ignore", invalid="ignore"):
            return x[0] * numpy.exp(-unit * x[1] * t) + x[2] - y

    def jacobian(x):
        with numpy.errstate(over="ignore", invalid="ignore"):
            e = numpy.exp(-unit * x[1] * t)
            return numpy.stack([e, -unit * t * x[0] * e, t**0], 1)

    return Input([1, 1 / unit, 0], residual, jacobian, **more)


def valley(**more):
    return Input([-1.2, 1], lambda x: numpy.array([10 * (x[1] - x[0] ** 2), 1 - x[0]]),
                 lambda x: numpy.array([[-20 * x[0], 10], [-1, 0]]), **more)


def bounded_valley(**more):
    return valley(bounds=(numpy.array([-2.0, -2]), numpy.array([0.5, 2])), **more)


def solved():
    weights = numpy.sqrt([1, 2, 3])
    return Input([1, 1, 1], lambda x: weights * (x - 1), lambda _: numpy.diag(weights))


def missing(of_residuals, **more):
    if of_residuals:
        nothing = numpy.array([math.nan, math.nan])
        return Input([10], lambda x: numpy.array([math.log(x[0]), 0.1 * (x[0] - 1)]) if x[0] > 0 else nothing,
                     lambda x: numpy.array([[1 / x[0] if x[0] > 0 else math.nan], [0.1]]), **more)
    return Input([10], lambda x: x, lambda x: numpy.ones((1, 1)),
                 loss=lambda x: float(x[0] - math.log(x[0])) if x[0] > 0 else math.nan,
                 slope=lambda x: numpy.array([1 - 1 / x[0]]) if x[0] > 0 else numpy.array([math.nan]), **more)
