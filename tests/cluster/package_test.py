"""The Debian package: made, unpacked and used as on a node that has no compiler. Skipped (77) where
the tools that make it are not installed."""

import glob
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

TOOLS = ["cpack", "dpkg-deb", "dpkg-shlibdeps"]


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        made = subprocess.run(["cpack", "-G", "DEB", "--config", f"{sys.argv[1]}/CPackConfig.cmake",
                               "-B", cls.folder], capture_output=True, text=True, check=False)
        assert made.returncode == 0, made.stdout + made.stderr
        [cls.package] = glob.glob(f"{cls.folder}/isoline_*_*.deb")
        subprocess.run(["dpkg-deb", "-x", cls.package, f"{cls.folder}/root"], check=True)

    def run_it(self, *words):
        """With nothing on the path."""
        run = subprocess.run([f"{self.folder}/root/usr/bin/isoline", *words], cwd=self.folder,
                             env={"PATH": "/nowhere"}, capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run.stdout

    def field(self, name):
        return subprocess.run(["dpkg-deb", "-f", self.package, name], capture_output=True,
                              text=True, check=True).stdout

    def test_it_depends_on_what_the_program_links_and_on_no_compiler(self):
        needed = self.field("Depends")
        for library in ["libfftw3", "libopenblas", "liblapacke", "libnlopt", "libceres", "libdnnl",
                        "libcminpack", "libgsl"]:
            self.assertIn(library, needed)
        for tool in ["g++", "gcc", "cmake", "-dev"]:
            self.assertNotIn(tool, needed.replace("libgcc", ""))

    def test_it_holds_the_program_its_client_records_and_licenses_and_nothing_else(self):
        files = sorted(os.path.relpath(os.path.join(folder, name), f"{self.folder}/root")
                       for folder, _, names in os.walk(f"{self.folder}/root") for name in names)
        client = [name for name in files if name.startswith("usr/share/isoline/python/")]
        self.assertIn("usr/share/isoline/python/isoline.py", client)
        self.assertTrue(all(name.endswith(".py") for name in client), client)
        peers = [name for name in files if name.startswith("usr/share/isoline/peers/")]
        self.assertIn("usr/share/isoline/peers/peers.py", peers)
        guide = [name for name in files if name.startswith("usr/share/doc/isoline/docs/")]
        self.assertIn("usr/share/doc/isoline/docs/running-a-matrix.md", guide)
        published = [name for name in files if name.startswith("usr/share/isoline/published/runs/")]
        self.assertTrue(published and all(name.endswith(".json") for name in published))
        files = [name for name in files if name not in client + peers + guide + published]
        self.assertEqual(files, ["usr/bin/isoline"] + [f"usr/share/{name}" for name in (
            "bash-completion/completions/isoline", "doc/isoline/CHANGELOG.md",
            "doc/isoline/README.md", "doc/isoline/copyright",
            "fish/vendor_completions.d/isoline.fish", "man/man1/isoline.1",
            "zsh/vendor-completions/_isoline")])
        for name in files:
            self.assertGreater(os.path.getsize(f"{self.folder}/root/{name}"), 0, name)
        with open(f"{self.folder}/root/usr/share/doc/isoline/copyright", encoding="utf-8") as text:
            notice = text.read()
        self.assertIn("GNU General Public License", notice)
        self.assertIn("MIT", notice)
        self.assertIn("GNU General Public License", self.field("Description"))

    def test_it_runs_and_reports(self):
        self.run_it("run", "--problem", "square,sine", "--optimizer", "gd,ceres-lm", "--iterations",
                    "20", "--out", "out", "--quiet")
        self.assertTrue(os.path.exists(f"{self.folder}/out/report/index.html"))
        self.run_it("report", "out", "--out", "again")
        self.assertTrue(os.path.exists(f"{self.folder}/again/index.html"))

    def test_its_records_are_those_of_the_program_it_was_made_of(self):
        matrix = ["--problem", "poisson[N=8]", "--optimizer", "gd,newton", "--iterations", "20"]
        self.run_it("run", *matrix, "--out", "packed", "--no-report", "--quiet")
        subprocess.run([f"{sys.argv[1]}/isoline", "run", *matrix, "--out", "built", "--no-report",
                        "--quiet"], cwd=self.folder, check=True)
        self.assertIn("Comparison: equal", self.run_it("compare", "built", "packed"))


if __name__ == "__main__":
    if missing := [tool for tool in TOOLS if shutil.which(tool) is None]:
        print(f"skipped: {', '.join(missing)} not installed (Debian's packages cmake and dpkg-dev)")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
