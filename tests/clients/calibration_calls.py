"""How many simulator calls a fit by Isoline takes, from the start of `isoline run` in a new folder to its exit.

    python3 calibration_calls.py MODULE.py [--isoline PATH] [--optimizer SPEC] [--problem TEXT] [--only NAME]... [--digits 6]

MODULE.py lists PROBLEMS with name, names, units, x0, lower, upper, data, sigma and forward(x, digits), which raises an
exception where the simulator fails; MODULE_best.json has the least losses. A call is a line that forward appends to a
file; each of the first six takes 0.15 s, as those of slow simulators do. The loss is judged with all digits.
"""
import argparse
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile

SCRIPT = """
import importlib.util, os, sys, time
import isoline
spec = importlib.util.spec_from_file_location("module", {module!r})
module = importlib.util.module_from_spec(spec)
sys.modules["module"] = module
spec.loader.exec_module(module)
p = next(p for p in module.PROBLEMS if p.name == {name!r})
sigma = [1.0] * len(p.data) if p.sigma is None else list(p.sigma)

def forward(x):
    with open({calls!r}, "a") as log:
        log.write(" ".join(map(repr, map(float, x))) + "\\n")
    if os.path.getsize({calls!r}) and sum(1 for _ in open({calls!r})) <= 6:
        time.sleep(0.15)
    return [y / s for y, s in zip(p.forward(list(x), {digits!r}), sigma)]

isoline.problem(forward, start=p.x0, target=[d / s for d, s in zip(p.data, sigma)], start_scale="own",
                bounds=(p.lower, p.upper), names=p.names, units=p.units, name=p.name{more})
"""


def loaded(path):
    spec = importlib.util.spec_from_file_location("module", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["module"] = module
    spec.loader.exec_module(module)
    return module


def loss(problem, x):
    try:
        y = problem.forward(x)
    except (ArithmeticError, ValueError):
        return float("inf")
    sigma = problem.sigma or [1.0] * len(y)
    return sum(((a - d) / s) ** 2 for a, d, s in zip(y, problem.data, sigma))


def fit(problem, module, given):
    """(calls to the fit or None, all calls, counted calls, final loss, status)"""
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        calls = work / "calls.txt"
        more = ", differences=True" if given.differences else ""
        (work / "fit.py").write_text(SCRIPT.format(module=module, name=problem.name, calls=str(calls), digits=given.digits,
                                                   more=more))
        command = [given.isoline, "run", "--problem", 'process[command="%s fit.py"]' % sys.executable, "--optimizer",
                   given.optimizer, "--out", "out", "--no-report", *given.more]
        said = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        records = list((work / "out" / "runs").glob("*.json"))
        if not records:
            sys.exit(said.stdout)
        record = json.loads(records[0].read_text())
        seen = [[float(v) for v in line.split()] for line in calls.read_text().splitlines()]
        best = given.best[problem.name]["loss"]
        first = next((i + 1 for i, x in enumerate(seen) if loss(problem, x) <= (1 + given.within) * best), None)
        answer = record.get("answer")
        end = loss(problem, answer["x"][0]) / best if answer else float("nan")
        return first, len(seen), record["summary"]["work"], end, record["status"], record.get("message", "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("module")
    parser.add_argument("--isoline", default="isoline")
    parser.add_argument("--optimizer", default="levenberg-marquardt")
    parser.add_argument("--only", action="append")
    parser.add_argument("--digits", type=int)
    parser.add_argument("--differences", action="store_true", help="the script offers products by differences")
    parser.add_argument("--within", type=float, default=1e-6)
    parser.add_argument("more", nargs="*", help="further arguments of isoline run, after --")
    given = parser.parse_args()
    module = str(pathlib.Path(given.module).resolve())
    given.isoline = str(pathlib.Path(given.isoline).resolve()) if "/" in given.isoline else given.isoline
    given.best = json.loads(pathlib.Path(module.replace(".py", "_best.json")).read_text())
    print("| problem | calls to 1+%g | total calls | counted | final / best loss | status |\n|---|--:|--:|--:|--:|---|" % given.within)
    for problem in loaded(module).PROBLEMS:
        if given.only and problem.name not in given.only:
            continue
        first, calls, counted, end, status, message = fit(problem, module, given)
        print("| %s | %s | %d | %d | %.7f | %s %s |" % (problem.name, first or "never", calls, counted, end, status, message),
              flush=True)


if __name__ == "__main__":
    main()
