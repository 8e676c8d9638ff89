#!/usr/bin/env python3
# y = x of so many numbers, by the client: what a forward of the adapter costs around the function.
import sys

import isoline

isoline.problem(lambda x: x, [0.0] * int(sys.argv[1]), vjp=lambda x, u: u, name="echo")
