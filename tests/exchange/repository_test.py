"""The workflow of the example repository of results, step by step as its shell runs it.
repository_test.py ISOLINE"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

TREE = pathlib.Path(__file__).parents[2]
WORKFLOW = TREE / "docs/results-repository/.github/workflows/results.yml"
README = TREE / "docs/results-repository/README.md"


def steps():
    """Scripts by the name of their step."""
    found = re.findall(r"- name: (\w+)\n +run: \|\n((?: {10}.*\n)+)", WORKFLOW.read_text("utf-8"))
    return {name: re.sub("^ {10}", "", text, flags=re.M) for name, text in found}


def packing():
    return re.search(r"^```\n(.*?)^```$", README.read_text("utf-8"), re.M | re.S)[1]


class Repository(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "bin").mkdir()
        (self.folder / "bin/isoline").symlink_to(sys.argv[1])
        self.run_in("isoline run --problem square --optimizer gd,adam --iterations 20 --quiet "
                    "--no-report --out ours")
        self.pack("ours")
        self.run_in("mkdir -p main && cp -r archive main/")

    def run_in(self, script, code=0):
        path = f"{self.folder}/bin:{os.environ['PATH']}"
        run = subprocess.run(["sh", "-e", "-c", script], cwd=self.folder, capture_output=True,
                             text=True, env=dict(os.environ, PATH=path), check=False)
        self.assertEqual(run.returncode, code, script + run.stdout + run.stderr)
        return run.stdout + run.stderr

    def pack(self, name):
        self.run_in(packing().replace("NAME", name))

    def run_steps(self, **codes):
        """All steps, up to the first that fails; `codes` has its exit code."""
        self.run_in("rm -rf published submitted site")
        for name, script in steps().items():
            if name == "site" and "unknown command" in self.run_in("isoline help site 2>&1 || true"):
                continue
            self.run_in(script, codes.get(name, 0))
            if name in codes:
                return

    def test_new_and_unchanged_results_pass(self):
        self.assertEqual(list(steps()), ["unpack", "manifests", "validate", "compare", "replay", "site"])
        self.run_steps()
        self.run_in("isoline run --problem square --optimizer newton --quiet --no-report --out theirs")
        self.pack("theirs")
        self.run_steps()

    def test_changed_or_removed_results_fail(self):
        self.run_in("tar -xzf archive/ours.tar.gz && echo >> ours/plan.json && "
                    "tar -czf archive/ours.tar.gz ours")
        self.run_steps(manifests=1)
        self.run_in("rm $(ls ours/runs/*.json | head -n 1)")
        self.pack("ours")
        self.run_steps(compare=2)
        self.run_in("rm -r ours archive/ours.tar.gz && isoline run --problem square --optimizer gd "
                    "--quiet --no-report --out theirs")
        self.pack("theirs")
        self.run_steps(compare=1)

    def test_members_outside_the_own_folder_and_links_are_refused(self):
        for make, named in (("mkdir -p theirs && cp -r ours theirs && cd theirs", "ours"),
                            ("ln -s /etc/passwd ours/link", "ours"), ("mkfifo ours/fifo", "ours")):
            self.run_in(f"rm -rf archive/* theirs ours/link ours/fifo; ({make}; tar -czf a.tgz {named})"
                        f"; find . -name a.tgz -exec mv {{}} archive/"
                        f"{'mallory' if 'theirs' in make else 'ours'}.tar.gz ';'")
            self.run_steps(unpack=1)
        self.run_in("rm -rf archive/* ours/link ours/fifo && tar -czf 'archive/o*.tar.gz' ours")
        self.run_steps(unpack=1)  # the name is no pattern

    def test_new_results_that_cannot_be_repeated_fail(self):
        self.run_in("isoline run --problem square --optimizer newton --quiet --no-report --out theirs")
        record = next((self.folder / "theirs/runs").glob("*.json"))
        text = record.read_text("utf-8")
        changed = re.sub(r'("rejected_steps": *)0', r"\g<1>1", text)
        self.assertNotEqual(changed, text)
        record.write_text(changed, "utf-8")
        self.pack("theirs")
        self.run_steps(replay=2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
