"""The page "On a cluster" does what it says: its commands on a real SLURM, its examples for other
schedulers as far as they run without them. Skipped (77) where SLURM is not installed."""

import glob
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import slurm

# What GNU parallel does here: the command once an argument, in its place.
PARALLEL = """#!/bin/sh
command=
while [ "$1" != ::: ]; do command="$command $1"; shift; done
shift
for each; do eval "$(echo "$command" | sed "s/{}/$each/")" || exit; done
"""


def commands_of(fence):
    return [line for line in slurm.block(fence) if not line.startswith("#")]


class Page(unittest.TestCase):
    """The ten commands run the suite that they name; the others a part of it, of its name."""

    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        os.mkdir(f"{self.folder}/bin")
        os.makedirs(f"{self.folder}/build/portable")
        for place in ["isoline", "bin/isoline", "build/portable/isoline"]:
            os.symlink(sys.argv[1], f"{self.folder}/{place}")
        slurm.write_scripts(self.folder)
        suites = pathlib.Path(__file__).parents[2] / "benchmarks" / "suites"
        suite = json.loads((suites / "notebook.json").read_text(encoding="utf-8"))
        part = {"schema": suite["schema"], "name": suite["name"], "version": 1, "matrix": suite["matrix"][:6]}
        pathlib.Path(self.folder, "notebook.json").write_text(json.dumps(part), encoding="utf-8")
        self.environment = dict(os.environ, PATH=f"{self.folder}/bin:{os.environ['PATH']}")

    def run_line(self, line, **variables):
        run = subprocess.run(line, shell=True, cwd=self.folder, capture_output=True, text=True,
                             env=self.environment | variables, check=False)
        self.assertEqual(run.returncode, 0, f"{line}\n{run.stdout}{run.stderr}")
        return run.stdout

    def run_part(self, line, **variables):
        return self.run_line(line.replace(" run notebook ", " run notebook.json "), **variables)

    def assert_is_the_whole(self, merged, suite="notebook.json"):
        if not os.path.exists(f"{self.folder}/whole"):
            self.run_line(f"isoline run {suite} --out whole --no-report --quiet")
        self.assertIn("Comparison: equal", self.run_line(f"isoline compare whole {merged}"))
        self.assertTrue(os.path.exists(f"{self.folder}/{merged}/report/index.html"))

    def test_ten_commands_lead_from_the_plan_to_the_report(self):
        commands = commands_of("shell")
        self.assertEqual(len(commands), 10)
        with slurm.Slurm() as cluster:
            self.environment |= cluster.environment | {"PATH": self.environment["PATH"]}
            for command in commands:
                self.assertNotEqual(self.run_line(command), "", command)
        status = json.loads(self.run_line("isoline run results/notebook --dry-run --json"))
        self.assertEqual((status["done"], status["left"]), (status["planned"], 0))
        self.assert_is_the_whole("results/notebook/merged", "notebook")

    def test_gnu_parallel_does_the_shards(self):
        path = pathlib.Path(self.folder) / "bin" / "parallel"
        path.write_text(PARALLEL, encoding="utf-8")
        path.chmod(0o755)
        for line in commands_of("shell parallel"):
            self.run_part(line)
        self.assert_is_the_whole("results/notebook/merged")

    def test_every_other_scheduler_does_the_shards(self):
        """The four tasks of an array, numbered as each scheduler numbers them."""
        condor = dict(line.split(" = ", 1) for line in slurm.block("shell shard.condor")[:-1])
        job = "\n".join(slurm.block("yaml shard.yaml"))
        name, value = re.search(r'env: \[\{name: (\w+), value: "(\d+)"\}\]', job).groups()
        self.assertIn(f"completions: {value},", job)
        self.assertIn("-v ISOLINE_SHARDS=4", slurm.block("shell shard.pbs")[1])
        scripts = {
            "\n".join(slurm.block("shell shard.pbs")):
                {"PBS_ARRAY_INDEX": "{1}", "PBS_O_WORKDIR": self.folder, "ISOLINE_SHARDS": "4"},
            "\n".join(slurm.block("shell shard.lsf")):
                {"LSB_JOBINDEX": "{1}", "LSB_JOBINDEX_END": "4", "LSB_JOBINDEX_STEP": "1"},
            "\n".join(slurm.block("shell shard.sge")):
                {"SGE_TASK_ID": "{1}", "SGE_TASK_FIRST": "1", "SGE_TASK_LAST": "4"},
            f"{condor['executable']} {condor['arguments']}":
                dict(one.replace("$(Process)", "{0}").split("=")
                     for one in condor["environment"].strip('"').split()),
            re.search(r"command: \[(.*?)\]", job)[1].replace(",", ""):
                {"JOB_COMPLETION_INDEX": "{0}", name: value},
        }
        self.assertEqual(len(scripts), 5)
        for script, variables in scripts.items():
            self.run_part("rm -rf results merged; isoline run notebook --dry-run --shards 4")
            pathlib.Path(self.folder, "results/notebook/isoline").symlink_to(sys.argv[1])
            for task in range(4):
                self.run_part(script, **{variable: text.format(task, task + 1)
                                         for variable, text in variables.items()})
            self.run_part("isoline merge results/notebook/shards/* --out merged")
            self.run_part("isoline report merged")
            self.assert_is_the_whole("merged")

    def test_a_workflow_does_the_shards(self):
        lines = commands_of("yaml")
        self.assertLessEqual(len(lines), 12)
        plan, run, merge = re.findall(r"run: '(.*?)'\}", "\n".join(lines))
        self.run_part(plan, GITHUB_OUTPUT="output")
        written = pathlib.Path(self.folder, "output").read_text(encoding="utf-8")
        name, _, matrix = written.partition("=")
        self.assertEqual(name, "plan")
        for job in json.loads(matrix)["shards"]:
            self.run_part(run.replace("${{ matrix.shard }}", job["shard"]))
        self.run_part(merge, GITHUB_STEP_SUMMARY="summary")
        self.assertGreater(os.path.getsize(f"{self.folder}/summary"), 0)
        self.assertEqual(len(glob.glob(f"{self.folder}/results/notebook/shards/*")), 4)
        self.assert_is_the_whole("merged")


if __name__ == "__main__":
    if missing := slurm.what_is_missing():
        print(f"skipped: {missing}")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
