"""Optimizers of other packages, by the scripts of clients/peers. Those that are missing are skipped with their name."""

import re
import subprocess
import sys
import tempfile
import unittest

from runs import CLIENTS, SECONDS, process, run

ISOLINE = sys.argv.pop(1)
PEERS = CLIENTS / "peers"


def listed():
    """The specs of those that are installed, and what was said about others."""
    with tempfile.TemporaryDirectory() as folder:
        found = subprocess.run([sys.executable, PEERS / "peers.py"], cwd=folder, capture_output=True, text=True,
                               timeout=SECONDS, check=True)
    return found.stdout.splitlines(), found.stderr


class Peers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.specs, cls.missing = listed()
        if not cls.specs:
            raise unittest.SkipTest(f"no peer is installed: {cls.missing}")

    def scipy(self, method):
        spec = next((each for each in self.specs if each.endswith(f"scipy_optimize.py {method}\"]")), None)
        return spec or self.skipTest("SciPy is not installed")

    def test_each_script_is_short_and_listed(self):
        listing = (PEERS / "peers.py").read_text()
        for script in PEERS.iterdir():
            if script.suffix in (".py", ".R", ".m", ".cpp") and script.name != "peers.py":
                self.assertLessEqual(len(script.read_text().splitlines()), 40, script.name)
                self.assertIn(f'"{script.name}"', listing)

    def test_what_is_missing_is_named_with_its_package(self):
        for line in self.missing.splitlines():
            self.assertRegex(line, "apt install ")

    def test_all_that_are_installed_run(self):
        said, records = run(ISOLINE, "rosenbrock", "@peers", "--work", "1000", "--iterations", "100000")
        self.assertEqual(len(records), len(self.specs), said)
        for label, record in records.items():
            self.assertNotIn(record["status"], ("failed", "crashed", "timeout", "inapplicable"), f"{label}: {record}")
            self.assertLess(record["summary"]["loss"], 0.5 * record["summary"]["start_loss"], label)
        if self.missing:
            print(self.missing, file=sys.stderr)

    def test_none_leaves_the_bounds_that_it_is_given(self):
        _, records = run(ISOLINE, "burgers[N=16,bounds=active]", "@peers", "--work", "200")
        self.assertEqual(len(records), len(self.specs))
        for label, record in records.items():
            self.assertNotEqual(record["status"], "failed", f"{label}: {record.get('message')}")

    def test_trial_points_of_slsqp_do_not_end_its_run(self):
        _, records = run(ISOLINE, "wood", self.scipy("slsqp"))
        record = records["scipy-slsqp"]
        self.assertIn(record["status"], ("target", "converged", "unconfirmed"), record.get("message"))
        self.assertLess(record["summary"]["loss"], 1e-5)

    def test_a_reported_point_that_was_evaluated_is_free(self):
        """SciPy reports an iterate after the differences around the next one."""
        command = re.search('command="([^"]*) bfgs', self.scipy("l-bfgs-b").replace("l-bfgs-b", "bfgs"))[1]
        _, records = run(ISOLINE, "rosenbrock", process(command, "bfgs jac=2-point"), "--target", "0")
        record = records["scipy-bfgs jac=2-point"]
        own = int(re.search(r"nfev=(\d+)", record["claimed"])[1])
        # Isoline shares one solve where a point follows itself.
        self.assertLessEqual(record["counts"]["forward"], own)


if __name__ == "__main__":
    unittest.main()
