"""Roots, which fail where bounds do not keep x from them."""

import math

import isoline


def forward(x):
    return [math.sqrt(each) for each in x]


def vjp(x, u):
    return [w / (2 * math.sqrt(each)) for each, w in zip(x, u)]


isoline.problem(
    forward, [0.25, 4], truth=[2, 3], vjp=vjp, bounds=(0.25, [9, math.inf]), name="roots"
)
