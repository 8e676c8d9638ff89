#!/usr/bin/env bash
# pyswarms 1.3.0: a second optimize() returns the best cost of both runs with the position of the last.
#
# Guess before the run: a second call goes on where the first one ended, or starts again; either way
# the cost that it returns is that of the position beside it.
# Seen: on Rosenbrock's function with x1 <= 0.5, 25 iterations at a time, the first pair agrees. A
# second run keeps the swarm and its best cost, and forgets the best position of each particle: where
# it finds nothing better, it returns the old cost, 0.27610, and the best position of its own, with
# 0.27670. Of four calls for each of four seeds three pairs differ. swarm.best_pos is the right one.
. "$(dirname "$0")/packages.sh"
debian python3-pyswarms=1.3.0-5 python3-numpy=1:1.24.2-1+deb12u1
cat >"$work/run.py" <<'P'
import logging

import numpy as np
import pyswarms

logging.disable(logging.CRITICAL)


def rosenbrock(x):
    return 100 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1 - x[:, 0]) ** 2


for seed in range(4):
    np.random.seed(seed)
    swarm = pyswarms.single.GlobalBestPSO(20, 2, {"c1": 0.5, "c2": 0.3, "w": 0.9},
                                          bounds=(np.array([-2.0, -2]), np.array([0.5, 2])))
    for run in range(4):
        cost, position = swarm.optimize(rosenbrock, 25, verbose=False)
        at, kept = rosenbrock(np.array([position, swarm.swarm.best_pos]))
        print(f"seed {seed}, run {run}: cost {cost:.5f}, at its position {at:.5f}, at best_pos {kept:.5f}")
P
export PYTHONPATH=$root/usr/lib/python3/dist-packages
cd "$work"  # pyswarms writes a log file
run() { /usr/bin/python3 "$work/run.py" 2>/dev/null; }
expect 'seed 0, run 0: cost 0.40086, at its position 0.40086, at best_pos 0.40086
seed 0, run 1: cost 0.28369, at its position 0.28369, at best_pos 0.28369
seed 0, run 2: cost 0.26883, at its position 0.26883, at best_pos 0.26883
seed 0, run 3: cost 0.26523, at its position 0.26523, at best_pos 0.26523
seed 1, run 0: cost 0.50657, at its position 0.50657, at best_pos 0.50657
seed 1, run 1: cost 0.39258, at its position 0.39258, at best_pos 0.39258
seed 1, run 2: cost 0.26071, at its position 0.26071, at best_pos 0.26071
seed 1, run 3: cost 0.25323, at its position 0.25323, at best_pos 0.25323
seed 2, run 0: cost 0.27610, at its position 0.27610, at best_pos 0.27610
seed 2, run 1: cost 0.27610, at its position 0.27670, at best_pos 0.27610
seed 2, run 2: cost 0.26959, at its position 0.26959, at best_pos 0.26959
seed 2, run 3: cost 0.26959, at its position 0.26960, at best_pos 0.26959
seed 3, run 0: cost 0.30563, at its position 0.30563, at best_pos 0.30563
seed 3, run 1: cost 0.26738, at its position 0.26738, at best_pos 0.26738
seed 3, run 2: cost 0.26738, at its position 0.26999, at best_pos 0.26738
seed 3, run 3: cost 0.26028, at its position 0.26028, at best_pos 0.26028' run
