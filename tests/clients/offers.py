"""The same map with one kind of product, or none: the word is what isoline.problem() is given."""

import sys

import isoline

kind = sys.argv[1]


def forward(x):
    return [x[0] * x[0], x[0] * x[1], 3 * x[1]]


def vjp(x, u):
    return [2 * x[0] * u[0] + x[1] * u[1], x[0] * u[1] + 3 * u[2]]


def jvp(x, v):
    return [2 * x[0] * v[0], x[1] * v[0] + x[0] * v[1], 3 * v[1]]


def jacobian(x):
    return [[2 * x[0], 0], [x[1], x[0]], [0, 3]]


given = {"vjp": vjp, "jvp": jvp, "jacobian": jacobian}
more = {kind: given[kind]} if kind in given else {}
isoline.problem(forward, [1, 2], truth=[2, 1], name=kind, differences=kind == "differences", **more)
