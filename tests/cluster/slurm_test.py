"""A run in shards on a real SLURM of one node. Skipped (77) where SLURM is not installed."""

import glob
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import slurm

# Some cells that take a moment, of methods that keep their state.
MATRIX = ["--problem", "poisson[N=32]", "--optimizer", "gd[rate=2e-5],momentum[rate=2e-6]", "--seeds", "6", "--target", "0"]
SHORT = MATRIX + ["--iterations", "2000"]
LONG = MATRIX + ["--iterations", "40000"]
CELLS = 12


class OnSlurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = slurm.Slurm()
        cls.enterClassContext(cls.cluster)
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        slurm.write_scripts(cls.folder)

    def tell(self, *words, code=0):
        """What isoline prints, and that it ends with this code."""
        run = subprocess.run([sys.argv[1], *words], cwd=self.folder, capture_output=True, text=True,
                             env=self.cluster.environment, check=False)
        self.assertEqual(run.returncode, code, f"{words}\n{run.stdout}{run.stderr}")
        return run.stdout

    def submit(self, out, tasks, matrix):
        """The number of the array; the merge is submitted too."""
        self.tell("run", "--dry-run", *matrix, "--shards", str(tasks), "--out", out)
        os.mkdir(f"{self.folder}/{out}/logs")
        shutil.copy(sys.argv[1], f"{self.folder}/{out}/isoline")
        job = self.sbatch(out, f"--array=1-{tasks}", "--time=10", "shard.sh", out, *matrix)
        self.sbatch(out, "--dependency=singleton", "merge.sh", out, f"{out}/merged")
        return job

    def sbatch(self, out, *words):
        run = subprocess.run(["sbatch", "--parsable", f"--job-name={out}", "--output=" +
                              f"{self.folder}/{out}/logs/%x-%a.log", *words], cwd=self.folder,
                             capture_output=True, text=True, env=self.cluster.environment, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout.strip()

    def status(self, out):
        return json.loads(self.tell("run", out, "--dry-run", "--json"))

    def logs_of(self, out):
        return "".join(pathlib.Path(log).read_text(encoding="utf-8")
                       for log in sorted(glob.glob(f"{self.folder}/{out}/logs/*")))

    def assert_is_the_whole(self, out, matrix):
        whole = "whole-" + matrix[-1]
        if not os.path.exists(f"{self.folder}/{whole}"):
            self.tell("run", *matrix, "--out", whole, "--no-report", "--quiet")
        logs = self.logs_of(out)
        self.assertTrue(os.path.exists(f"{self.folder}/{out}/merged/report/index.html"), logs)
        self.assertIn(f"{CELLS} equal", self.tell("compare", whole, f"{out}/merged"), logs)
        status = self.status(out)
        self.assertEqual((status["done"], status["left"]), (CELLS, 0))

    def processes_of(self, out):
        """The runs of a folder's tasks, without their cells, by shard."""
        found = {}
        for path in glob.glob("/proc/[0-9]*/cmdline"):
            try:
                with open(path, encoding="utf-8") as text:
                    words = text.read().split("\0")
                with open(path.replace("cmdline", "stat"), encoding="utf-8") as text:
                    parent = text.read().rsplit(")", 1)[1].split()[1]
                with open(f"/proc/{parent}/comm", encoding="utf-8") as text:
                    is_task = "isoline" not in text.read()
            except (OSError, UnicodeDecodeError):
                continue
            if is_task and out in words and "--shard" in words and "isoline" in words[0]:
                found[words[words.index("--shard") + 1]] = int(path.split("/")[2])
        return found

    def wait_until_it_runs(self, out, shards):
        self.cluster.wait_for(
            lambda: set(shards) <= set(self.processes_of(out)) and
            self.status(out)["running"] >= len(shards), f"shards {shards} of {out}")

    def test_tasks_together_give_what_one_run_gives(self):
        for tasks in [1, 2, 4]:
            with self.subTest(tasks=tasks):
                out = f"out-{tasks}"
                self.submit(out, tasks, SHORT)
                self.cluster.wait_until_empty()
                self.assertEqual(len(glob.glob(f"{self.folder}/{out}/shards/*-of-{tasks}")), tasks)
                self.assert_is_the_whole(out, SHORT)

    def test_tasks_that_are_stopped_or_killed_go_on_and_lose_nothing(self):
        job = self.submit("stopped", 2, LONG)
        self.wait_until_it_runs("stopped", ["1/2", "2/2"])
        self.cluster.tell("scancel", "--batch", "--signal=TERM", f"{job}_1")
        os.kill(self.processes_of("stopped")["2/2"], signal.SIGKILL)
        self.cluster.wait_until_empty()
        self.assertIn("interrupted; ", self.logs_of("stopped"))
        for task in ["1", "2"]:
            self.assertIn("Restarts=1 ", self.cluster.tell("scontrol", "show", "job",
                                                           f"{job}_{task}"))
        self.assert_is_the_whole("stopped", LONG)

    def test_a_drained_node_ends_its_tasks_and_starts_no_more_until_it_is_back(self):
        self.submit("drained", 4, LONG)
        self.wait_until_it_runs("drained", ["1/4", "2/4"])
        self.set_node("drain")
        self.cluster.wait_for(lambda: not self.cluster.jobs("RUNNING"), "the running tasks")
        self.assertEqual(self.processes_of("drained"), {})
        self.assertFalse(os.path.exists(f"{self.folder}/drained/shards/4-of-4"))
        self.assertFalse(os.path.exists(f"{self.folder}/drained/merged"))
        self.set_node("resume")
        self.cluster.wait_until_empty()
        self.assert_is_the_whole("drained", LONG)

    def test_a_node_that_fails_has_its_tasks_done_again(self):
        self.submit("failed", 2, LONG)
        self.wait_until_it_runs("failed", ["1/2", "2/2"])
        self.set_node("down")
        self.cluster.wait_for(lambda: not self.processes_of("failed"), "the tasks to end")
        self.set_node("resume")
        self.cluster.wait_until_empty()
        self.assert_is_the_whole("failed", LONG)

    def test_a_job_that_its_user_cancels_stays_cancelled(self):
        job = self.submit("cancelled", 2, LONG)
        self.wait_until_it_runs("cancelled", ["1/2", "2/2"])
        for each in {name.split("_")[0] for name in self.cluster.jobs()}:
            self.cluster.tell("scancel", each)
        self.cluster.wait_until_empty()
        self.assertEqual(self.processes_of("cancelled"), {})
        self.assertIn("JobState=CANCELLED", self.cluster.tell("scontrol", "show", "job",
                                                              f"{job}_1"))

    def set_node(self, state):
        self.cluster.tell("scontrol", "update", f"NodeName={self.cluster.host}", f"State={state}",
                          "Reason=test")


if __name__ == "__main__":
    if missing := slurm.what_is_missing():
        print(f"skipped: {missing}")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
