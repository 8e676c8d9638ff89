"""DFO-LS (Cartis, Fiala, Marteau, Roberts 2019): pip install DFO-LS

python3 dfo_ls.py, or python3 dfo_ls.py noisy for a problem whose calls are noisy.
"""
import sys

import dfols

import isoline

p = isoline.optimizer(name=" ".join(["dfo-ls", *sys.argv[1:]]), least_squares=True)
MOST = 10**6  # it allocates memory for each: 8 GB at 10**9
found = dfols.solve(p.residual, p.x0, objfun_has_noise="noisy" in sys.argv, maxfun=MOST, rhoend=1e-14)
p.finish(found.x, found.msg)
