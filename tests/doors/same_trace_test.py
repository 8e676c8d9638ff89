"""One problem through every adapter: a built-in component, a child process, UM-Bridge and a C
library give the same trace, bit for bit, since their arithmetic is the same. Called with the
program, the valley in Python, and the library of the example in C."""

import glob
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, VALLEY, LIBRARY = sys.argv[1:4]
TIMES = {"wall_seconds", "processor_seconds"}


class Doors(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def record(self, name, problem, optimizer, *more):
        run = subprocess.run(
            [PROGRAM, "run", "--problem", problem, "--optimizer", optimizer, "--out", name,
             "--iterations", "60", "--target", "0", "--rates", "none", "--no-report", *more],
            cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        (path,) = glob.glob(f"{self.folder}/{name}/runs/*.json")
        return json.loads(pathlib.Path(path).read_text(encoding="utf-8"))

    def in_python(self, optimizer, tree):
        """By the arithmetic of this build: its compiler rounds x2 - x1^2 once, or twice."""
        records = [self.record(f"{kind}-{optimizer[:2]}",
                               f'process[command="{sys.executable} {VALLEY} {kind}"]', optimizer)
                   for kind in ["fused", "plain"]]
        return next((record for record in records
                     if record["curve"]["loss"] == tree["curve"]["loss"]), records[0])

    def test_descents_take_the_same_steps_through_all_of_them(self):
        for optimizer in ["levenberg-marquardt", "gd[rate=1e-3]"]:
            tree = self.record(f"tree-{optimizer[:2]}", "rosenbrock", optimizer)
            self.assertGreater(len(tree["curve"]["loss"]), 5)
            self.assertNotIn("foreign", tree)
            doors = {
                "process": self.in_python(optimizer, tree),
                "plugin": self.record(f"plugin-{optimizer[:2]}", "rosenbrock-c", optimizer,
                                      "--plugin", LIBRARY)}
            for door, record in doors.items():
                with self.subTest(door=door, optimizer=optimizer):
                    self.assertEqual(record["foreign"]["problem"]["door"], door)
                    self.assertEqual(record["counts"], tree["counts"])
                    self.assertEqual(record["found"], tree["found"])
                    for name in set(tree["curve"]) - TIMES:
                        self.assertEqual(record["curve"][name], tree["curve"][name], name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
