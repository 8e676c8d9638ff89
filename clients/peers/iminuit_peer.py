"""MIGRAD of iminuit: python3 iminuit_peer.py. It takes its own differences.

It needs iminuit, on Debian: apt install python3-iminuit
"""
import iminuit
import isoline

p = isoline.optimizer(name="iminuit-migrad", keeps_bounds=True, failed=1e100)
minuit = iminuit.Minuit(lambda x: 2 * p.value(x), p.x0)  # Σ r², whose errordef is 1
minuit.limits = list(zip(p.lower, p.upper))
minuit.migrad(ncall=10**9)
p.finish(list(minuit.values), f"valid={minuit.valid} nfcn={minuit.nfcn} edm={minuit.fmin.edm:g}")
