"""What somebody asks of `isoline serve --record` is a record like any other: valid, reported, judged
by its problem's own measure."""

import glob
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import served


def descend(models, steps):
    """Gradient descent, as any outsider would write it."""
    _, x = models.evaluate("square.data", [])
    for _ in range(steps):
        slope = models.gradient("square.loss", [x], [1.0])
        x = [x[i] - 0.02 * slope[i] for i in range(len(x))]
        models.evaluate("square.loss", [x])
    return x


class Recorded(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())

    def isoline(self, *arguments):
        run = subprocess.run([sys.argv[1], *arguments], cwd=self.folder, capture_output=True,
                             text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run.stdout

    def served(self, *arguments):
        return served.serving(sys.argv[1], *arguments, cwd=self.folder)

    def records(self):
        texts = [pathlib.Path(path).read_text(encoding="utf-8")
                 for path in sorted(glob.glob(f"{self.folder}/mine/runs/*.json"))]
        return [json.loads(text) for text in texts]

    def test_a_run_of_somebody_elses_method(self):
        with self.served("square", "rosenbrock", "--record", "mine", "--client", "my-descent") \
                as models:
            descend(models, 20)
        (record,) = self.records()  # nobody asked the other
        self.assertEqual(record["request"]["problem"]["name"], "square")
        self.assertEqual(record["request"]["optimizer"]["options"]["client"], "my-descent")
        self.assertEqual(record["foreign"]["optimizer"]["label"], "my-descent")
        self.assertEqual(record["counts"]["forward"], 21)
        self.assertEqual(record["counts"]["pullback"], 20)
        self.assertEqual(record["summary"]["iterations"], 20)
        losses = record["curve"]["loss"]
        self.assertEqual(losses, sorted(losses, reverse=True))
        self.assertEqual(record["privileges"], [])
        self.isoline("validate", "mine")
        said = self.isoline("report", "mine")
        self.assertIn("my-descent", said)
        self.assertTrue(os.path.exists(f"{self.folder}/mine/report/index.html"))

    def test_it_is_judged_as_the_trees_own_run_would_be(self):
        with self.served("square", "--record", "mine") as models:
            descend(models, 20)
        (record,) = self.records()
        self.isoline("run", "--problem", "square", "--optimizer", "gd[rate=0.02]", "--iterations",
                     "20", "--target", "0", "--out", "own", "--no-report")
        (path,) = glob.glob(f"{self.folder}/own/runs/*.json")
        own = json.loads(pathlib.Path(path).read_text(encoding="utf-8"))
        for key in ["minimum", "scale", "x_scale", "verified", "found"]:
            self.assertEqual(record.get(key), own.get(key), key)
        for mine, its in zip(record["curve"]["loss"], own["curve"]["loss"]):
            self.assertAlmostEqual(mine, its, delta=1e-12 * own["summary"]["start_loss"])

    def test_an_inverse_is_a_privilege(self):
        with self.served("rosenbrock", "--record", "mine") as models:
            _, x0 = models.evaluate("rosenbrock.data", [])
            (x,) = models.evaluate("rosenbrock.inverse", [[0.0, 0.0], x0])
            models.evaluate("rosenbrock", [x])
        (record,) = self.records()
        self.assertEqual(record["status"], "target")
        self.assertEqual(record["privileges"], ["exact inverse of the physics"])

    def test_it_stands_beside_runs_of_the_trees_methods(self):
        self.isoline("run", "--problem", "square", "--optimizer", "adam,gd", "--out", "own",
                     "--no-report")
        with self.served("square", "--record", "mine", "--client", "my-descent") as models:
            descend(models, 20)
        said = self.isoline("report", "own", "mine", "--out", "both")
        for name in ("adam", "my-descent"):
            self.assertIn(name, said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
