"""The optimizers of other packages that this folder has scripts for.

    python3 peers.py            the specs of those that are installed, one a line; what is missing on standard error
    python3 peers.py packages   the command that installs all packages on Debian
    python3 peers.py run FILE.cpp ARGUMENTS   builds it where it is new, and becomes it
"""
import hashlib
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

HERE = pathlib.Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "python" / "examples"
CACHE = pathlib.Path("results/cache")  # of the folder that runs go to
PYTHONS = ("python3", "/usr/bin/python3")
PETSC = "import glob, sys; sys.path += glob.glob('/usr/lib/petscdir/*/*-real*/lib/python3/dist-packages'); import numpy, petsc4py"

# Debian packages, what must work, the file, its methods.
SCRIPTS = [
    ("python3-scipy", "import scipy", EXAMPLES / "scipy_optimize.py",
     ("trf", "dogbox", "l-bfgs-b", "slsqp", "trust-constr", "nelder-mead", "powell", "cobyla")),
    ("python3-lmfit", "import lmfit", HERE / "lmfit_peer.py", ("leastsq", "least_squares")),
    ("python3-iminuit", "import iminuit", HERE / "iminuit_peer.py", ("",)),
    ("python3-petsc4py python3-numpy", PETSC, EXAMPLES / "pounders.py", ("",)),
    ("python3-petsc4py python3-numpy", PETSC, HERE / "tao.py", ("brgn", "blmvm", "lmvm")),
    ("r-cran-minpack.lm", "library(minpack.lm)", HERE / "r_packages.R", ("nls.lm",)),
    ("r-cran-nloptr", "library(nloptr)", HERE / "r_packages.R", ("nloptr",)),
    ("r-cran-minqa", "library(minqa)", HERE / "r_packages.R", ("bobyqa",)),
    ("octave-optim", "pkg load optim", HERE / "leasqr.m", ("",)),
    ("g++ libdlib-dev libblas-dev", "dlib/optimization.h", HERE / "dlib.cpp", ("bobyqa", "lbfgs", "global")),
    ("g++ libalglib-dev", "libalglib/optimization.h", HERE / "alglib.cpp", ("",)),
    ("g++ libalglib-dev", "libalglib/optimization.h", HERE / "alglib_gradient.cpp", ("minlbfgs", "minbleic")),
    ("g++ liblbfgs-dev", "lbfgs.h", HERE / "lbfgs.cpp", ("",)),
    ("g++ coinor-libipopt-dev", "coin/IpStdCInterface.h", HERE / "ipopt.cpp", ("",)),
    ("g++ libpagmo-dev libeigen3-dev", "pagmo/population.hpp", HERE / "pagmo.cpp", ("cmaes", "de")),
]


def works(*command):
    try:
        return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=60).returncode == 0
    except (FileNotFoundError, subprocess.TimeoutExpired):
        return False


def start_of(file, need):
    """The words that start the file, or none where what it needs does not work."""
    if file.suffix == ".py":
        return next(([python] for python in PYTHONS if works(python, "-c", need)), None)
    if file.suffix == ".cpp":
        with tempfile.NamedTemporaryFile("w", suffix=".cpp") as source:
            source.write(f"#if !__has_include(<{need}>)\n#error\n#endif\n")
            source.flush()
            has_header = works("c++", "-E", source.name)
        return ["python3", str(HERE / "peers.py"), "run"] if has_header else None
    starts = {".R": (["Rscript"], "-e"), ".m": (["octave-cli", "-qf"], "--eval")}
    words, flag = starts[file.suffix]
    return ["python3", "-m", "lines", *words] if works(*words, flag, need) else None


def built(source):
    """The program of this source, built where the cache lacks it."""
    text = source.read_bytes()
    headers = sorted({HERE / "peer.h", *source.parent.glob("*.h")})
    flags = re.search(r"^// flags: (.*)$", text.decode(), re.MULTILINE)
    digest = hashlib.sha256(text + b"".join(each.read_bytes() for each in headers)).hexdigest()[:16]
    program = CACHE / f"{source.stem}-{digest}"
    if not program.exists():
        CACHE.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=CACHE) as folder:  # two processes may build it at once
            new = pathlib.Path(folder) / "program"
            subprocess.run(["c++", "-std=c++20", "-O1", "-w", f"-I{HERE}", "-o", new, source,
                            *(flags[1].split() if flags else [])], check=True)
            new.rename(program)
    return program


def list_installed():
    with ThreadPoolExecutor() as pool:
        starts = list(pool.map(lambda each: start_of(each[2], each[1]), SCRIPTS))
    for (packages, _, file, methods), start in zip(SCRIPTS, starts):
        try:
            if start and file.suffix == ".cpp":
                built(file)
        except subprocess.CalledProcessError:
            start = None
        if start is None:
            print(f"isoline: {file.name} is left out; on Debian: apt install {packages}", file=sys.stderr)
            continue
        for method in methods:
            command = shlex.join([*start, str(file), *([method] if method else [])])
            print(f'process[command="{command}"]')


if __name__ == "__main__":
    if sys.argv[1:2] == ["packages"]:
        print("apt install", *sorted({name for each in SCRIPTS for name in each[0].split()}))
    elif sys.argv[1:2] == ["run"]:
        program = built(pathlib.Path(sys.argv[2])).resolve()
        os.execv(program, [str(program), *sys.argv[3:]])
    else:
        list_installed()
