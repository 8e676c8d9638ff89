#!/usr/bin/env bash
# petsc4py 3.18.5: Mat.setValues reads a NumPy array in Fortran's order as its transpose, with no error.
#
# Guess before the run: the binding goes by the array's shape and strides, as NumPy does, or refuses the order.
# Seen: values of the shape (2, 3) in Fortran's order land by memory: rows come out mixed. The same numbers in C's order are
# right, and a slice with steps is right, too. Jacobians from SciPy, from J.T or from order="F" arrays are such arrays.
# Pass numpy.ascontiguousarray(values).
. "$(dirname "$0")/packages.sh"
debian python3-petsc4py=3.18.5-1 python3-numpy=1:1.24.2-1+deb12u1
cat >"$work/run.py" <<'P'
import glob
import os
import sys

import numpy

root = os.environ["root"]
sys.path += glob.glob(f"{root}/usr/lib/petscdir/*/*-real/lib/python3/dist-packages")
sys.path += glob.glob("/usr/lib/petscdir/*/*-real/lib/python3/dist-packages")
import petsc4py

petsc4py.init(["run"])
from petsc4py import PETSc

values = numpy.arange(1.0, 7).reshape(2, 3)
wide = numpy.zeros((2, 6))
wide[:, ::2] = values
for name, array in [("C", values), ("Fortran", numpy.asfortranarray(values)), ("steps", wide[:, ::2])]:
    matrix = PETSc.Mat().createDense((2, 3), comm=PETSc.COMM_SELF).setUp()
    matrix.setValues(range(2), range(3), array)
    matrix.assemble()
    print(f"{name}: {matrix.getDenseArray().tolist()}")
P
export root PYTHONPATH=$root/usr/lib/python3/dist-packages
expect 'C: [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
Fortran: [[1.0, 4.0, 2.0], [5.0, 3.0, 6.0]]
steps: [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]' /usr/bin/python3 "$work/run.py"
