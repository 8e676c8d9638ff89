"""POUNDERS of PETSc's TAO, by quadratic models of each residual; Wild (2017).

python3 pounders.py, or python3 pounders.py 0.1 for another first radius than 1
It needs petsc4py, on Debian: apt install python3-petsc4py
"""
import glob
import sys

import numpy

sys.path += glob.glob("/usr/lib/petscdir/*/*-real*/lib/python3/dist-packages")  # of Debian
import petsc4py

radius = float(sys.argv[1]) if len(sys.argv) > 1 else 1
petsc4py.init([""])
from petsc4py import PETSc
import isoline

MOST = 2**31 - 1  # an int
p = isoline.optimizer(name=" ".join(["pounders", *sys.argv[1:]]), least_squares=True, keeps_bounds=True,
                      failed=1e10)  # at 1e100 its quadratic models keep no digit of the other points
vector = lambda values: PETSc.Vec().createWithArray(numpy.array(values, float), comm=PETSc.COMM_SELF)
within = lambda x: numpy.clip(x.getArray(), p.lower, p.upper)  # it leaves bounds by a rounding
# The points of its first models must lie below the upper bounds.
radius = min(radius, 0.4 * (p.upper - p.lower).min())
x = vector(numpy.minimum(p.x0, p.upper - radius))
method = PETSc.TAO().create(PETSc.COMM_SELF)
method.setType("pounders")
finite = lambda r: numpy.clip(r, -1e100, 1e100)  # a sum of squares that overflows ends it with an error
method.setResidual(lambda _, x, r: r.setArray(finite(p.residual(within(x)))), vector(numpy.zeros(p.residuals)))
if numpy.isfinite([p.lower, p.upper]).any():
    method.setVariableBounds(vector(p.lower), vector(p.upper))
PETSc.Options().setValue("tao_pounders_delta", radius)
method.setTolerances(gatol=1e-14, grtol=0, gttol=0)
method.setMaximumIterations(MOST)
method.setMaximumFunctionEvaluations(MOST)
method.setFromOptions()
method.solve(x)
p.finish(within(x), f"reason {method.getConvergedReason()} of TaoConvergedReason")
