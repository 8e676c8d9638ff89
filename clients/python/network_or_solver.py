"""Compares one network, trained jointly on N inverse problems, with solvers on each of them alone.

    python3 clients/python/network_or_solver.py wave-packet --instances 32 --steps 1000

Holl, Thuerey (2024), arXiv 2408.08119: the network has no test set. It is trained on the very N
observations y* that the solvers get, and each solver starts where the untrained network does. Each
instance is allowed the same work: a step of training costs a forward solve and a pullback per
instance, and the solvers end after as much. The loss is that of the instance, 1/2 |P(x) - y*|^2.

    network   the instances on which the loss of the network is below that of the solver
    shuffled  the same of a network that sees the y* of another instance, as a null hypothesis
    refined   the instances on which the same solver, which continues from the answer of the network with as
              much work again, ends below its run from the start with all of that work
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys
import tempfile

PRICE = 2  # of a training step per instance: a forward solve and a pullback
PLENTY = 10 ** 6  # iterations: the work ends a run


class Failed(Exception):
    """A command that failed, with its output."""


def with_options(spec, more):
    """sine[xi=32] and mode=learn: sine[xi=32,mode=learn]."""
    return f"{spec[:-1]},{more}]" if spec.endswith("]") else f"{spec}[{more}]"


def split_specs(text):
    """The specifications of a list; commas within brackets do not separate."""
    specs, depth = [""], 0
    for letter in text:
        depth += (letter == "[") - (letter == "]")
        if letter == "," and depth == 0:
            specs.append("")
        else:
            specs[-1] += letter
    return specs


class Contest:
    def __init__(self, given, folder):
        self.given, self.folder = given, folder
        self.solvers = split_specs(given.solvers)

    def isoline(self, *arguments):
        done = subprocess.run([self.given.isoline, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise Failed(f"{' '.join(map(str, arguments))}: {done.stderr.strip() or done.stdout.strip()}")

    def answers(self, name, steps, optimizer, inputs=""):
        """A file of y* and a list of the x of a network, one row per instance."""
        network, x, y = (self.folder / f"{name}.{end}" for end in ("json", "x.csv", "y.csv"))
        count = self.given.instances
        spec = with_options(self.given.problem, f"mode=learn,data={count},batch={count}{inputs}")
        self.isoline("train", spec, "--optimizer", optimizer, "--iterations", steps, "--seed",
                     self.given.seed, "--out", network, "--quiet")
        self.isoline("solution", network, "--training-data", y, "--out", x)
        return y.read_text().split(), x.read_text().split()

    def losses(self, name, y, x, work):
        """Of each solver: the loss at the start x, and the lowest ones within half the work and all of it."""
        start, data, out = (self.folder / f"{name}.{end}" for end in ("start.csv", "data.csv", "runs"))
        start.write_text(x + "\n")
        data.write_text(y + "\n")
        self.isoline("run", "--problem", self.given.problem, "--optimizer", self.given.solvers, "--seeds", "1",
                     "--start", start, "--target-data", data, "--work", max(work, 1), "--iterations", PLENTY,
                     "--target", "0", "--jobs", "1", "--no-report", "--quiet", "--out", out)
        found = {}
        for file in (out / "runs").glob("*.json"):
            record = json.loads(file.read_text(encoding="utf-8"))
            optimizer = record["request"]["optimizer"]
            curve, summary = record["curve"], record["summary"]
            # Of the stored iterations, 7 % apart, up to the first at or beyond half the work.
            stored = sum(spent < work / 2 for spent in curve["work"]) + 1
            for spec in (optimizer["asked"], optimizer["spec"]):
                found[spec] = [number(summary["start_loss"]), min(map(number, curve["loss"][:stored])),
                               number(summary["best_loss"])]
        return [found[solver] for solver in self.solvers]

    def of_all(self, name, y, x, work):
        """The losses of all instances, in their order."""
        with concurrent.futures.ThreadPoolExecutor(self.given.jobs) as pool:
            return list(pool.map(lambda i: self.losses(f"{name}-{i}", y[i], x[i], work), range(len(y))))


def number(value):
    """A loss that is not finite wins nothing."""
    value = float(value)
    return value if value < float("inf") else float("inf")


def median(values):
    ordered = sorted(values)
    return (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2


def shares(contest):
    """One row per solver."""
    given = contest.given
    work = PRICE * given.steps
    y, untrained = contest.answers("untrained", 1, "gd[rate=1e-300]")
    trained = contest.answers("network", given.steps, given.training)[1]
    shuffled = contest.answers("shuffled", given.steps, given.training, ",inputs=shuffled")[1]
    alone = contest.of_all("alone", y, untrained, 2 * work)
    refined = contest.of_all("refined", y, trained, work)
    null = contest.of_all("null", y, shuffled, 1)
    for s, solver in enumerate(contest.solvers):
        at = {name: [each[s][end] for each in runs] for name, runs, end in (
            ("network", refined, 0), ("shuffled", null, 0), ("alone", alone, 1), ("whole", alone, 2),
            ("refined", refined, 2))}
        wins = {name: sum(a < b for a, b in zip(at[name], at[other])) for name, other in (
            ("network", "alone"), ("shuffled", "alone"), ("refined", "whole"))}
        yield solver, wins, {name: median(values) for name, values in at.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("problem", help="a problem with mode=learn, such as burgers[N=32]")
    parser.add_argument("--instances", type=int, default=32, help="N (default: 32)")
    parser.add_argument("--steps", type=int, default=1000, help="steps of training (default: 1000)")
    parser.add_argument("--training", default="adam", help="a method of one gradient per step (default: adam)")
    parser.add_argument("--solvers", default="nlopt-lbfgs,levenberg-marquardt",
                        help="default: nlopt-lbfgs,levenberg-marquardt")
    parser.add_argument("--seed", type=int, default=0, help="of the instances and the network")
    parser.add_argument("--jobs", type=int, default=1, help="solvers at a time")
    parser.add_argument("--isoline", default="./isoline", help="the program (default: ./isoline)")
    given = parser.parse_args()
    try:
        with tempfile.TemporaryDirectory() as folder:
            rows = list(shares(Contest(given, pathlib.Path(folder))))
    except (Failed, OSError) as error:
        sys.exit(f"network_or_solver: {error}")
    count = given.instances
    print(f"{given.problem}: {count} instances, {PRICE * given.steps} forward solves each, "
          f"{given.steps} steps of {given.training}\n")
    print(f"{'solver':24}{'network':>9}{'shuffled':>9}{'refined':>9}   median loss: "
          f"{'network':>9}{'shuffled':>10}{'solver':>10}{'refined':>10}")
    for solver, wins, losses in rows:
        counts = "".join(f"{f'{wins[name]}/{count}':>9}" for name in ("network", "shuffled", "refined"))
        figures = "".join(f"{losses[name]:10.2g}" for name in ("network", "shuffled", "alone", "refined"))
        print(f"{solver:24}{counts}   {'':12}{figures}")


if __name__ == "__main__":
    main()
