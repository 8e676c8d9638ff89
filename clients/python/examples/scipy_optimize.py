"""A method of scipy.optimize: python3 scipy_optimize.py lm, or trf, bfgs, l-bfgs-b …

Tolerances follow the method: python3 scipy_optimize.py lm ftol=1e-8 xtol=1e-8 gtol=1e-8
With jac=2-point or jac=3-point, SciPy takes differences, and Isoline counts their forward solves.
trf, dogbox, l-bfgs-b, slsqp, nelder-mead and powell respect the bounds of a problem; tnc leaves them
by a rounding.
slsqp and cobyla hand trial points to their callback, also those that are rejected later: there, each
new best point counts as an iteration.
"""
import sys

from scipy.optimize import Bounds, least_squares, minimize

import isoline

method, *given = sys.argv[1:]
words = dict(each.split("=") for each in given)
differences = words.pop("jac", None)
options = {name: float(value) for name, value in words.items()}
label = f"scipy-{' '.join([method, *given])}"
takes_no_derivatives = method.lower() in ("nelder-mead", "powell", "cobyla")
keeps_bounds = method.lower() in ("trf", "dogbox", "l-bfgs-b", "slsqp", "nelder-mead", "powell")
if method in ("lm", "trf", "dogbox"):
    tight = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15, "max_nfev": 10**9}
    p = isoline.optimizer([] if differences else ["jacobian"], label, least_squares=True,
                          keeps_bounds=keeps_bounds)
    bounds = {"bounds": (p.lower, p.upper)} if keeps_bounds else {}
    found = least_squares(p.residual, p.x0, differences or p.jacobian, method=method, **bounds,
                          **{**tight, **options})
else:
    reports = method.lower() not in ("slsqp", "cobyla")
    has_gradient = not (differences or takes_no_derivatives)
    p = isoline.optimizer(["pullback"] if has_gradient else [], label, reports=reports,
                          keeps_bounds=keeps_bounds)
    bounds = {"bounds": Bounds(p.lower, p.upper)} if keeps_bounds else {}
    found = minimize(p.value, p.x0, jac=p.gradient if has_gradient else differences,
                     method=method, **bounds, callback=p.report if reports else None, options=options)
p.finish(found.x, f"{found.message} nfev={found.nfev} njev={found.get('njev')}")
