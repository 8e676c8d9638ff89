"""A chain of nonlinear springs in NumPy: which displacements produce the observed forces?"""
import numpy as np

import isoline

n = 20


def forward(u):  # the forces that hold the nodes at u: T' of springs with tension T(s) = s + s³
    stretch = np.diff(u, prepend=0.0, append=0.0)
    return -np.diff(stretch + stretch**3)


def vjp(u, w):  # J is symmetric: it is the Hessian of the springs' energy
    stretch = np.diff(u, prepend=0.0, append=0.0)
    return -np.diff((1 + 3 * stretch**2) * np.diff(w, prepend=0.0, append=0.0))


rest = np.sin(np.linspace(0, np.pi, n + 2))[1:-1]
isoline.problem(forward, np.zeros(n), truth=rest, vjp=vjp, jvp=vjp, name="spring")
