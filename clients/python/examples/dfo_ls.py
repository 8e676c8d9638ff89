"""DFO-LS (Cartis, Fiala, Marteau, Roberts 2019): pip install DFO-LS

python3 dfo_ls.py, or python3 dfo_ls.py noisy for a problem whose calls are noisy.
"""
import sys

import dfols

import isoline

p = isoline.optimizer(name=" ".join(["dfo-ls", *sys.argv[1:]]), least_squares=True)
found = dfols.solve(p.residual, p.x0, objfun_has_noise="noisy" in sys.argv, maxfun=10**9,
                    rhoend=1e-14)
p.finish(found.x, found.msg)
