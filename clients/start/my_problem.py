"""My problem: P(x) = (x1 + c x2², x2 + c x1²), x* = (1/2, −1/2). State the formula, its
source, and any deviation from the source."""
import isoline

C = 0.25


def forward(x):
    return [x[0] + C * x[1] ** 2, x[1] + C * x[0] ** 2]


def jvp(x, v):  # J v
    return [v[0] + 2 * C * x[1] * v[1], v[1] + 2 * C * x[0] * v[0]]


def vjp(x, u):  # Jᵀ u
    return [u[0] + 2 * C * x[0] * u[1], u[1] + 2 * C * x[1] * u[0]]


isoline.problem(forward, start=[1, 1], truth=[0.5, -0.5], jvp=jvp, vjp=vjp, name="my-problem")
