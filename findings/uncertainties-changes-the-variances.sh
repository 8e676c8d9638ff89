#!/usr/bin/env bash
# Python's uncertainties 3.1.6: correlated_values of a covariance that is not one changes the variances without a word.
#
# Guess before the run: a matrix with a negative eigenvalue, such as a printed correlation matrix that was rounded or put
# together from several fits, raises an error; so does 1.001 as a correlation.
# Seen: negative eigenvalues are set to zero, so standard deviations of 1 become 1.125, correlations of 0.9 become 0.5, and
# the number that follows has no warning. numpy's multivariate_normal warns for the same matrix. Check eigenvalues before.
. "$(dirname "$0")/packages.sh"
debian python3-uncertainties=3.1.6-1 python3-numpy=1:1.24.2-1+deb12u1
cat >"$work/run.py" <<'P'
import warnings
import numpy, uncertainties
warnings.simplefilter("error")
C = numpy.array([[1, 0.9, -0.9], [0.9, 1, 0.9], [-0.9, 0.9, 1]])
x = uncertainties.correlated_values([0, 0, 0], C)
r = uncertainties.correlation_matrix(x)
print(f"least eigenvalue {numpy.linalg.eigvalsh(C)[0]:.1f}: deviations {x[0].s:.4f}, correlation {r[0][1]:.2f}")
a, b = uncertainties.correlated_values([1, 1], [[1, 1.001], [1.001, 1]])
print(f"correlation 1.001: deviation of the difference {(a - b).s:.3f}")
try:
    numpy.random.default_rng(1).multivariate_normal([0, 0, 0], C)
except RuntimeWarning:
    print("numpy warns")
P
export PYTHONPATH=$root/usr/lib/python3/dist-packages
expect 'least eigenvalue -0.8: deviations 1.1255, correlation 0.50
correlation 1.001: deviation of the difference 0.000
numpy warns' /usr/bin/python3 "$work/run.py"
