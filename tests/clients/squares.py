"""Unknowns of different magnitudes and two solutions, each of which counts as the true x."""

import isoline


def x_error(x):
    return min(sum((a - s) ** 2 for a in x) ** 0.5 for s in (1, -1))


isoline.problem(lambda x: [a * a for a in x], [1e-3, 1000], target=[1.01, 1.01], aim="x", x_error=x_error,
                x_floor=0.005, start_scale="own", jacobian=lambda x: [[2 * x[0], 0], [0, 2 * x[1]]])
