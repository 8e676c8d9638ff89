"""The page "Serving problems" does what it says: its scripts, its commands, its options."""

import json
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import unittest

PAGE = pathlib.Path(__file__).parents[2] / "docs" / "serving-problems.md"
SHOWN_PORT = "4242"


def block(fence):
    found = re.findall(rf"^```{re.escape(fence)}\n(.*?)^```$", PAGE.read_text(encoding="utf-8"),
                       re.M | re.S)
    assert len(found) == 1, f"{len(found)} blocks {fence}"
    return found[0]


class Page(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())
        os.mkdir(f"{self.folder}/bin")
        os.symlink(sys.argv[1], f"{self.folder}/bin/isoline")
        for name in ("descend.py", "model.py"):
            pathlib.Path(self.folder, name).write_text(block(f"python {name}"), encoding="utf-8")

    def run_block(self, fence):
        """As one script; another program may have the page's port."""
        with socket.create_server(("127.0.0.1", 0)) as probe:
            port = str(probe.getsockname()[1])
        run = subprocess.run(["bash", "-m", "-c", "set -e\n" + block(fence).replace(SHOWN_PORT, port)],
                             cwd=self.folder, capture_output=True, text=True, check=False, timeout=120,
                             env=dict(os.environ, PATH=f"{self.folder}/bin:{os.environ['PATH']}"))
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run.stdout

    def records(self, folder):
        return [json.loads(path.read_text(encoding="utf-8"))
                for path in pathlib.Path(self.folder, folder, "runs").glob("*.json")]

    def test_serving(self):
        said = self.run_block("shell serve")
        self.assertIn("my-descent", said)
        (record,) = self.records("results/mine")
        self.assertEqual(record["counts"]["pullback"], 500)
        self.assertLess(record["summary"]["loss"], 2)

    def test_sweeping(self):
        said = self.run_block("shell sweep")
        self.assertIn("springs[stiffness=2]", said)
        ends = {}
        for record in self.records("results/stiffness"):
            self.assertLess(record["summary"]["loss"], 1e-10, record["message"])
            ends[record["request"]["problem"]["options"]["stiffness"]] = record["trajectory"]["x"][-1]
        for stiffness, (x, y) in ends.items():
            self.assertAlmostEqual(stiffness * x ** 3 + y, 2, 4)
        self.assertEqual(sorted(ends), [1, 2])

    def test_bridging(self):
        said = self.run_block("shell model")
        self.assertIn("0 failed", said)
        for record in self.records("results/model"):
            self.assertLess(record["summary"]["loss"], 1e-10, record["message"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
