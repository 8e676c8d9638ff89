"""A method of PETSc's TAO: python3 tao.py brgn, blmvm or lmvm. POUNDERS is in the examples.

It needs petsc4py, on Debian: apt install python3-petsc4py
"""
import glob
import sys

import numpy

sys.path += glob.glob("/usr/lib/petscdir/*/*-real*/lib/python3/dist-packages")  # of Debian
import petsc4py

petsc4py.init([""])
from petsc4py import PETSc
import isoline

method, is_least_squares = sys.argv[1], sys.argv[1] == "brgn"
keeps_bounds = method != "lmvm"
p = isoline.optimizer(["jacobian" if is_least_squares else "pullback"], f"tao-{method}",
                      least_squares=is_least_squares, keeps_bounds=keeps_bounds, failed=1e10)
vector = lambda values: PETSc.Vec().createWithArray(numpy.array(values, float), comm=PETSc.COMM_SELF)
tao = PETSc.TAO().create(PETSc.COMM_SELF)
tao.setType(method)
if is_least_squares:
    tao.setResidual(lambda _, x, r: r.setArray(p.residual(x.getArray())), vector(numpy.zeros(p.residuals)))
    matrix = PETSc.Mat().createDense((p.residuals, p.n), comm=PETSc.COMM_SELF).setUp()
    by_rows = numpy.ascontiguousarray  # setValues takes a matrix by columns for its transpose
    fill = lambda J, values: (J.setValues(range(p.residuals), range(p.n), by_rows(values)), J.assemble())
    tao.setJacobianResidual(lambda _, x, J, __: fill(J, p.jacobian(x.getArray())), matrix, matrix)
else:
    tao.setObjective(lambda _, x: p.value(x.getArray()))
    tao.setGradient(lambda _, x, g: g.setArray(p.gradient(x.getArray())), vector(p.x0))
if keeps_bounds:
    tao.setVariableBounds(vector(p.lower), vector(p.upper))
tao.setMaximumIterations(2**31 - 1)
tao.setMaximumFunctionEvaluations(2**31 - 1)
x = vector(p.x0)
tao.solve(x)
p.finish(x.getArray(), f"reason {tao.getConvergedReason()} of TaoConvergedReason")
