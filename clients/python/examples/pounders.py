"""POUNDERS of PETSc's TAO, by quadratic models of each residual; Wild (2017).

python3 pounders.py, or python3 pounders.py 0.1 for another first radius than 1
It needs petsc4py, on Debian: apt install python3-petsc4py
"""
import glob
import sys

sys.path += glob.glob("/usr/lib/petscdir/*/*-real*/lib/python3/dist-packages")  # of Debian
import petsc4py

radius = float(sys.argv[1]) if len(sys.argv) > 1 else 1
petsc4py.init(["", "-tao_pounders_delta", str(radius)])
from petsc4py import PETSc
import isoline

p = isoline.optimizer(name=" ".join(["pounders", *sys.argv[1:]]), least_squares=True)
vector = lambda size: PETSc.Vec().createSeq(size)
x = vector(p.n)
x.setArray(p.x0)
method = PETSc.TAO().create(PETSc.COMM_SELF)
method.setType("pounders")
method.setResidual(lambda _, x, r: r.setArray(p.residual(x.getArray())), vector(p.residuals))
method.setTolerances(gatol=1e-14, grtol=0, gttol=0)
method.setMaximumIterations(10**9)
method.setFromOptions()
method.solve(x)
p.finish(x.getArray(), f"reason {method.getConvergedReason()} of TaoConvergedReason")
