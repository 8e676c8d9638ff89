"""A method of scipy.optimize: python3 scipy_optimize.py lm, or trf, bfgs, l-bfgs-b …

Tolerances follow the method: python3 scipy_optimize.py lm ftol=1e-8 xtol=1e-8 gtol=1e-8
"""
import sys

from scipy.optimize import least_squares, minimize

import isoline

method, *given = sys.argv[1:]
options = {name: float(value) for name, value in (each.split("=") for each in given)}
label = f"scipy-{' '.join([method, *given])}"
if method in ("lm", "trf", "dogbox"):
    tight = {"ftol": 1e-15, "xtol": 1e-15, "gtol": 1e-15, "max_nfev": 10**9}
    p = isoline.optimizer(["jacobian"], label, least_squares=True)
    found = least_squares(p.residual, p.x0, p.jacobian, method=method, **{**tight, **options})
else:
    p = isoline.optimizer(["pullback"], label, reports=True)
    found = minimize(p.value, p.x0, jac=p.gradient, method=method, callback=p.report,
                     options=options)
p.finish(found.x, f"{found.message} nfev={found.nfev} njev={found.get('njev')}")
