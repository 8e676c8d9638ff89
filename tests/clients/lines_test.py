"""A method in another language, by lines of text: clients/python/lines.py."""

import pathlib
import sys
import tempfile
import unittest

from runs import process, run

ISOLINE = sys.argv.pop(1)
HERE = pathlib.Path(__file__).resolve().parent


class Lines(unittest.TestCase):
    def of_shell(self, text, *more):
        """The run of a method in sh that is this text."""
        with tempfile.NamedTemporaryFile("w", suffix=".sh") as script:
            script.write(text)
            script.flush()
            return run(ISOLINE, "rosenbrock", process("python3 -m lines sh", script.name), *more)

    def test_run_a_method_in_sh_and_awk(self):
        text = (HERE / "halving.sh").read_text()
        _, records = self.of_shell(text, "--iterations", "20")
        record = records["halving in sh"]
        self.assertEqual((record["status"], record["summary"]["iterations"]), ("budget", 20))
        self.assertLess(record["summary"]["loss"], 0.5 * record["summary"]["start_loss"])
        self.assertGreater(record["counts"]["forward"], record["counts"]["pullback"])

    def test_the_claim_and_the_result_are_kept(self):
        _, records = self.of_shell("echo isoline optimizer name=idle; read -r x\n"
                                   "echo isoline claim no change; read -r x; echo isoline finish 1 1; read -r x\n")
        self.assertEqual(records["idle"]["claimed"], "no change")
        self.assertEqual(records["idle"]["summary"]["loss"], 0)

    def test_one_x_a_thousand_times_ends_a_run(self):
        text = ("echo isoline optimizer name=same; read -r x\n"
                "while echo isoline value 0.5 0.5; do read -r x || exit; done\n")
        record = self.of_shell(text)[1]["same"]
        self.assertEqual((record["status"], record["counts"]["forward"]), ("stalled", 1))
        self.assertIn("one x 1000 times", record["message"])

    def test_a_request_that_is_wrong_is_named(self):
        for request in ("valeu 1 2", "value 1 two", "jacobian 1 2"):
            said, _ = self.of_shell(f"echo isoline optimizer; read -r x; echo isoline {request}; read -r x")
            self.assertIn(request.split()[-1] if "two" in request else request.split()[0], said)
            self.assertIn("1 failed", said)

    def test_a_program_that_ends_early_is_said(self):
        said, _ = self.of_shell("echo isoline optimizer; read -r x; echo oh no; exit 3")
        self.assertIn("code 3", said)
        self.assertIn("oh no", said)

    def test_the_first_line_is_checked(self):
        self.assertIn("nonsense", self.of_shell("echo isoline optimizer nonsense; read -r x")[0])
        self.assertIn("isoline value", self.of_shell("echo isoline value 1 1; read -r x")[0])

    def test_a_failed_evaluation_is_a_number_where_the_method_asks_for_one(self):
        text = ("echo isoline optimizer name=far failed=1e100; read -r x; echo isoline value 1e200 1e200; read -r value\n"
                "echo isoline claim $value; read -r x; echo isoline finish 1 1; read -r x\n")
        self.assertEqual(self.of_shell(text)[1]["far"]["claimed"], "1e+100")


if __name__ == "__main__":
    unittest.main()
