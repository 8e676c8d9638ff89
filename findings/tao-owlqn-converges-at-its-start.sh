#!/usr/bin/env bash
# PETSc 3.18.5: TAO's owlqn ends a straight line's fit at its start: success, objective 1e23.
#
# Guess before the run: owlqn minimizes f + lambda |x|, as L-BFGS with a penalty, so that with
# lambda = 0 it agrees with lmvm, and its value is that of its point.
# Seen: 1 + 2 t with noise from (0, 0), lambda = 0: after 10 calls x is the start, where the sum of
# squares is 1332, the objective is reported as 1.2e23, and the reason is 4, CONVERGED_GRTOL: at the
# last trial, far away, the gradient is small beside the value. From (0.5, 1) it is still there
# after 4,003 calls, with an honest -5, as on 10 (x - 3)^2 + (y - 2)^2; where both curvatures are
# equal it reaches the least, in 174 calls. lmvm solves all four. And lmvm, cg and nm take bounds
# without a word and end outside, with reason 3; blmvm keeps them.
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

petsc4py.init(["run", "-tao_owlqn_lambda", "0"])
from petsc4py import PETSc

t = numpy.arange(10.0)
data = 1 + 2 * t + [0.03, -0.11, 0.08, 0.15, -0.02, -0.14, 0.06, 0.01, -0.09, 0.12]


def line(x):
    r = x[0] + x[1] * t - data
    return r @ r, 2 * numpy.array([r.sum(), r @ t])


def bowl(stretch):
    d = numpy.array([stretch, 1.0])
    return lambda x: (d @ (x - [3, 2]) ** 2, 2 * d * (x - [3, 2]))


def rosenbrock(x):
    a = x[1] - x[0] ** 2
    return 100 * a * a + (1 - x[0]) ** 2, numpy.array([-400 * a * x[0] - 2 * (1 - x[0]), 200 * a])


def vector(values):
    made = PETSc.Vec().createSeq(2, comm=PETSc.COMM_SELF)
    made.setArray(numpy.array(values, float))
    return made


def run(method, name, function, start, upper=None):
    calls = 0

    def both(tao, x, slope):
        nonlocal calls
        calls += 1
        value, gradient = function(x.getArray(readonly=1))
        slope.setArray(gradient)
        return value

    tao, x = PETSc.TAO().create(PETSc.COMM_SELF), vector(start)
    tao.setType(method)
    if method == "nm":
        tao.setObjective(lambda tao, x: function(x.getArray(readonly=1))[0])
    else:
        tao.setObjectiveGradient(both, vector([0, 0]))
    if upper:
        tao.setVariableBounds((vector([-2, -2]), vector(upper)))
    tao.setFromOptions()
    tao.solve(x)
    found = x.getArray()
    if upper:
        print(f"{method}, x1 <= 0.5: reason {tao.getConvergedReason()}, x1 = {found[0]:.3f}")
        return
    moved = "moved" if abs(found - start).max() > 1e-9 else "at its start"
    size = "over 1e20" if tao.getObjectiveValue() > 1e20 else "as reported" if numpy.isclose(
        tao.getObjectiveValue(), function(found)[0]) else "another"
    many = "over 4000" if calls > 4000 else "over 100" if calls > 100 else "few"
    print(f"{method}, {name} from {start}: reason {tao.getConvergedReason()}, {moved}, f(x) = {function(found)[0]:.4g}, "
          f"value {size}, calls {many}")


for method in ["owlqn", "lmvm"]:
    run(method, "line", line, [0, 0])
    run(method, "line", line, [0.5, 1])
    run(method, "bowl", bowl(1), [1, 1])
    run(method, "stretched bowl", bowl(10), [1, 1])
for method in ["lmvm", "cg", "nm", "blmvm"]:
    run(method, "", rosenbrock, [-1.2, 1], [0.5, 2])
P
export root PYTHONPATH=$root/usr/lib/python3/dist-packages OPAL_PREFIX=$root/usr
run() { /usr/bin/python3 "$work/run.py" 2>/dev/null; }
expect 'owlqn, line from [0, 0]: reason 4, at its start, f(x) = 1332, value over 1e20, calls few
owlqn, line from [0.5, 1]: reason -5, at its start, f(x) = 333.7, value another, calls over 4000
owlqn, bowl from [1, 1]: reason 3, moved, f(x) = 2.18e-17, value as reported, calls over 100
owlqn, stretched bowl from [1, 1]: reason -5, at its start, f(x) = 41, value another, calls over 4000
lmvm, line from [0, 0]: reason 3, moved, f(x) = 0.08716, value as reported, calls few
lmvm, line from [0.5, 1]: reason 3, moved, f(x) = 0.08716, value as reported, calls few
lmvm, bowl from [1, 1]: reason 3, moved, f(x) = 0, value as reported, calls few
lmvm, stretched bowl from [1, 1]: reason 3, moved, f(x) = 4.93e-32, value as reported, calls few
lmvm, x1 <= 0.5: reason 3, x1 = 1.000
cg, x1 <= 0.5: reason 3, x1 = 1.000
nm, x1 <= 0.5: reason 3, x1 = 1.000
blmvm, x1 <= 0.5: reason 3, x1 = 0.500' run
