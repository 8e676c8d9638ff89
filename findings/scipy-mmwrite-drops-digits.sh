#!/usr/bin/env bash
# SciPy 1.10.1: mmwrite writes a sparse matrix with one digit less than a dense one, so doubles do not survive.
#
# Guess before the run: what mmread reads is what mmwrite was given, bit for bit, as for numpy.save and R's writeMM.
# Seen: a sparse matrix is written with 16 significant digits, a dense one with 17: 0.1 + 0.2 comes back as 0.3. Of 1,000
# random numbers 258 change in their last bit. Pass precision=17, or write the matrix as dense.
. "$(dirname "$0")/packages.sh"
debian python3-scipy=1.10.1-2 python3-numpy=1:1.24.2-1+deb12u1
cat >"$work/run.py" <<'P'
import sys

import numpy
from scipy.io import mmread, mmwrite
from scipy.sparse import coo_matrix

values = numpy.random.Generator(numpy.random.PCG64(1)).random((1, 1000))
values[0, 0] = 0.1 + 0.2
for name, matrix, words in [("sparse", coo_matrix(values), {}), ("dense", values, {}),
                            ("sparse, precision=17", coo_matrix(values), {"precision": 17})]:
    mmwrite(sys.argv[1], matrix, **words)
    found = mmread(sys.argv[1])
    found = found if isinstance(found, numpy.ndarray) else found.toarray()
    print(f"{name}: {(found != values).sum()} of 1000 changed, the first is {found[0, 0]!r}")
P
export PYTHONPATH=$root/usr/lib/python3/dist-packages
expect 'sparse: 258 of 1000 changed, the first is 0.3
dense: 0 of 1000 changed, the first is 0.30000000000000004
sparse, precision=17: 0 of 1000 changed, the first is 0.30000000000000004' /usr/bin/python3 "$work/run.py" "$work/a.mtx"
