#!/usr/bin/env python3
# The problem y = x of a given size, by the client: measures the overhead of a forward solve in the
# adapter.
import sys

import isoline

isoline.problem(lambda x: x, [0.0] * int(sys.argv[1]), vjp=lambda x, u: u, name="echo")
