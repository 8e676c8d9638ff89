"""The client of Python, driven as Isoline drives it: with NumPy where it is, and without."""

import glob
import importlib.util
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

CLIENT = sys.argv.pop(1)  # the folder that isoline.py lies in
HEAD = struct.Struct("<IIQ")
WITHOUT_NUMPY = "import sys; sys.modules['numpy'] = None\n"

try:
    import numpy  # noqa: F401

    HAS_NUMPY = True
except ImportError:
    HAS_NUMPY = False


class Program:
    """A script at the other end of a socket."""

    def __init__(self, text, has_numpy=True):
        ours, theirs = socket.socketpair()
        self.socket = ours
        self.script = tempfile.NamedTemporaryFile("w", suffix=".py")
        self.script.write(("" if has_numpy else WITHOUT_NUMPY) + text)
        self.script.flush()
        environment = dict(os.environ, ISOLINE_FD=str(theirs.fileno()), PYTHONPATH=CLIENT)
        environment["PYTHONDONTWRITEBYTECODE"] = "1"
        self.process = subprocess.Popen(
            [sys.executable, self.script.name], pass_fds=[theirs.fileno()], env=environment,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )
        theirs.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.socket.close()
        self.process.communicate()
        self.script.close()

    def send(self, verb, status, payload=b""):
        self.socket.sendall(HEAD.pack(verb, status, len(payload)) + payload)

    def receive(self):
        verb, status, count = HEAD.unpack(self.exactly(HEAD.size))
        return verb, status, self.exactly(count)

    def exactly(self, count):
        got = b""
        while len(got) < count:
            more = self.socket.recv(count - len(got))
            if not more:
                raise EOFError(self.process.stdout.read().decode())
            got += more
        return got

    def greet(self, role, **more):
        self.send(1, 0, json.dumps(dict(more, protocol=1, role=role)).encode())
        verb, status, payload = self.receive()
        assert verb == 1
        return status, payload

    def ask(self, verb, status, numbers):
        self.send(verb, status, struct.pack(f"<{len(numbers)}d", *numbers))
        answered, fate, payload = self.receive()
        assert answered == verb, answered
        if fate == 1:
            raise RuntimeError(payload.decode())
        return list(struct.unpack(f"<{len(payload) // 8}d", payload))


PROBLEM = """
import isoline
def forward(x): return [x[0] * x[0], x[0] * x[1], 3 * x[1]]
def vjp(x, u): return [2 * x[0] * u[0] + x[1] * u[1], x[0] * u[1] + 3 * u[2]]
def jvp(x, v): return [2 * x[0] * v[0], x[1] * v[0] + x[0] * v[1], 3 * v[1]]
def jacobian(x): return [[2 * x[0], 0], [x[1], x[0]], [0, 3]]
def inverse(y, x0): return [y[0] ** 0.5, y[2] / 3] if y[0] >= 0 else None
print("a stray line")
isoline.problem(forward, [1, 2 + isoline.seed()], truth=[2, 1], %s, name="three")
"""
ALL = "vjp=vjp, jvp=jvp, jacobian=jacobian, inverse=inverse"


class Problems(unittest.TestCase):
    has_numpy = True

    def program(self, text):
        return Program(text, self.has_numpy)

    def test_says_what_it_is(self):
        with self.program(PROBLEM % ALL) as program:
            status, payload = program.greet("problem", seed=3)
            said = json.loads(payload)
            self.assertEqual(status, 0)
            self.assertEqual((said["inputs"], said["outputs"], said["name"]), (2, 3, "three"))
            self.assertEqual(said["start"], [1, 5])
            self.assertEqual((said["target"], said["truth"]), ([4, 2, 3], [2, 1]))
            self.assertEqual(said["minimum"], 0)
            self.assertEqual(
                said["oracles"], ["forward", "pullback", "pushforward", "jacobian", "inverse"]
            )
            self.assertEqual("numpy" in said["packages"], self.has_numpy)
            self.assertIn(".".join(map(str, sys.version_info[:3])), said["interpreter"])

    def test_answers_at_the_point_that_is_named(self):
        with self.program(PROBLEM % ALL) as program:
            program.greet("problem", seed=0)
            self.assertEqual(program.ask(2, 0, [1, 2]), [1, 2, 6])
            self.assertEqual(program.ask(2, 7, [3, 4]), [9, 12, 12])
            self.assertEqual(program.ask(3, 0, [1, 1]), [2, 3, 3])
            self.assertEqual(program.ask(3, 7, [1, 1]), [6, 7, 3])
            self.assertEqual(program.ask(4, 0, [1, 1, 1]), [4, 4])
            self.assertEqual(program.ask(5, 7, []), [6, 4, 0, 0, 3, 3])

    def test_takes_batches_in_one_frame(self):
        with self.program(PROBLEM % ALL) as program:
            program.greet("problem", seed=0)
            self.assertEqual(program.ask(2, 1, [1, 2, 3, 4]), [1, 2, 6, 9, 12, 12])
            self.assertEqual(program.ask(4, 1, [1, 1, 1, 0, 0, 1]), [4, 4, 0, 3])
            self.assertEqual(program.ask(3, 1, [1, 1, 1, 1]), [2, 3, 3, 6, 7, 3])
            self.assertEqual(program.ask(5, 1, []), [2, 2, 0, 0, 1, 3, 6, 4, 0, 0, 3, 3])
            inverted = program.ask(6, 0, [4, 2, 3, -1, 2, 3] + [1, 2, 5, 6])
            self.assertEqual(inverted, [2, 1, 5, 6, 1, 0])

    def test_leaves_differences_to_isoline(self):
        with self.program(PROBLEM % "differences=True") as program:
            said = json.loads(program.greet("problem", seed=0)[1])
            self.assertTrue(said["differences"])
            self.assertEqual(said["oracles"], ["forward"])

    def test_offers_losses_alone_where_nothing_else_is_given(self):
        with self.program(PROBLEM % "vjp=None") as program:
            said = json.loads(program.greet("problem", seed=0)[1])
            self.assertEqual(said["oracles"], ["forward"])

    def test_says_what_went_wrong_and_goes_on(self):
        with self.program(PROBLEM % "vjp=lambda x, u: [1]") as program:
            program.greet("problem", seed=0)
            program.ask(2, 0, [1, 2])
            with self.assertRaisesRegex(RuntimeError, "vjp must return 2"):
                program.ask(4, 0, [1, 1, 1])
            self.assertEqual(program.ask(2, 0, [1, 2]), [1, 2, 6])

    def test_passes_what_is_not_finite(self):
        with self.program(PROBLEM.replace("3 * x[1]]", "float('inf')]") % "vjp=vjp") as program:
            said = json.loads(program.greet("problem", seed=0)[1])
            self.assertEqual(said["target"], [4, 2, "inf"])
            infinity = float("inf")
            self.assertEqual(program.ask(2, 0, [-infinity, 1])[:2], [infinity, -infinity])

    def test_has_no_value_where_a_formula_has_none(self):
        text = "import isoline, math\n" \
            "isoline.problem(lambda x: [math.exp(x[0]), 1 / x[1], math.log(x[1])], [1, 1], target=[0, 0, 0],\n" \
            "    jacobian=lambda x: [[math.exp(2 * x[0]), 0], [0, -1 / x[1]**2], [0, 1 / x[1]]])"
        with self.program(text) as program:
            program.greet("problem", seed=0)
            for nowhere in ([1000, 1], [1, 0], [1, -1]):
                self.assertTrue(all(y != y for y in program.ask(2, 0, nowhere)), nowhere)
                self.assertTrue(all(v != v for v in program.ask(5, 0, [])), nowhere)
            self.assertEqual(program.ask(2, 0, [0, 1]), [1, 1, 0])
            self.assertEqual(program.ask(5, 0, []), [1, 0, 0, 0, -1, 1])
            program.ask(2, 0, [400, 1])  # J alone overflows
            self.assertTrue(all(v != v for v in program.ask(5, 0, [])))

    def test_takes_frames_larger_than_its_buffer(self):
        text = "import isoline\nisoline.problem(lambda x: x, [0.0] * 20000, vjp=lambda x, u: u)"
        with self.program(text) as program:
            program.greet("problem", seed=0)
            numbers = [float(i) for i in range(20000)]
            self.assertEqual(program.ask(2, 0, numbers), numbers)

    def test_is_no_optimizer(self):
        with self.program(PROBLEM % ALL) as program:
            status, payload = program.greet("optimizer")
            self.assertEqual(status, 1)
            self.assertIn(b"this script is a problem", payload)

    def test_refuses_the_transpose_of_a_jacobian(self):
        text = "import isoline\n" \
            "isoline.problem(lambda x: [*x, x[0]], [1, 2], jacobian=lambda x: [[1, 0, 1], [0, 1, 0]])"
        with self.program(text) as program:
            program.greet("problem", seed=0)
            program.ask(2, 0, [1, 2])
            with self.assertRaisesRegex(RuntimeError, "3 rows of 2 numbers"):
                program.ask(5, 0, [])


class ProblemsWithoutNumPy(Problems):
    has_numpy = False


@unittest.skipUnless(HAS_NUMPY, "NumPy is not installed")
class ProblemsWithNumPy(Problems):
    def test_takes_a_column_of_an_array(self):
        text = "import isoline, numpy as np\nM = np.arange(6.).reshape(3, 2)\n" \
            "isoline.problem(lambda x: (M * x)[:, -1], M[:2, 0], jacobian=lambda x: M)"
        with self.program(text) as program:
            said = json.loads(program.greet("problem", seed=0)[1])
            self.assertEqual(said["start"], [0, 2])
            self.assertEqual(program.ask(2, 0, [1, 2]), [2, 6, 10])
            self.assertEqual(program.ask(5, 0, []), [0, 2, 4, 1, 3, 5])

    def test_refuses_what_doubles_cannot_hold(self):
        for result, word in [("np.array([1j])", b"complex"), ("None", b"lack a return"),
                             ("[1, None]", b"None"), ("['1']", b"real numbers"),
                             ("np.ma.masked_array([1., 2.], [0, 1])", b"masked")]:
            text = f"import isoline, numpy as np\nisoline.problem(lambda x: {result}, [1])"
            with self.program(text) as program:
                status, why = program.greet("problem", seed=0)
                self.assertEqual(status, 1, result)
                self.assertIn(word, why)


del Problems  # what the two share is no test by itself

OPTIMIZER = """
import isoline
p = isoline.optimizer(["pullback", "jacobian"], "mine", reports=True, least_squares=True)
assert list(p.x0) == [1, 2] and p.residuals == 3
assert p.value(p.x0) == 7
assert list(p.gradient(p.x0)) == [8, 9]
loss, slope = p.value_and_grad(p.x0)
assert loss == 7 and list(slope) == [8, 9]
assert [list(row) for row in p.jacobian(p.x0)] == [[1, 4], [2, 5], [3, 6]]
p.report(p.x0)
p.finish([5, 6], "done")
"""


class Commands(unittest.TestCase):
    """isoline.command, with a program of the shell."""

    TEMPLATE = "ptf ~\nk ~ k ~\nc ~c~ and ~ k ~\n"

    def ask(self, program, call, more=""):
        text = (
            "import isoline\n"
            f"model = isoline.command('sh program.sh in.txt', 'in.tpl'{more})\n"
            "try:\n"
            f"    print({call})\n"
            "except RuntimeError as error:\n"
            "    print(error)\n"
        )
        with tempfile.TemporaryDirectory() as folder:
            for name, content in {"program.sh": program, "in.tpl": self.TEMPLATE, "ask.py": text}.items():
                with open(os.path.join(folder, name), "w") as file:
                    file.write(content)
            environment = dict(os.environ, PYTHONPATH=CLIENT, PYTHONDONTWRITEBYTECODE="1")
            ran = subprocess.run(
                [sys.executable, "ask.py"], cwd=folder, env=environment, capture_output=True, text=True
            )
            left = sorted(os.listdir(folder))
        self.assertEqual(left, ["ask.py", "in.tpl", "program.sh"])  # it runs in another folder
        self.assertEqual(ran.stderr, "")
        return ran.stdout.strip()

    def test_fills_the_template_and_reads_numbers(self):
        self.assertEqual(self.ask("true", "model.names"), "['k', 'c']")
        self.assertEqual(self.ask("cat $1; ls", "model([0.1, 2])"), "[0.1, 2.0, 0.1]")
        self.assertEqual(
            self.ask("echo 5,6 > out.csv; echo 7", "model([1, 2])", ", read='out.csv'"), "[5.0, 6.0]"
        )
        self.assertEqual(
            self.ask("cp $1 out", "model([1, 2])", ", read=lambda folder: len(folder) > 1"), "True"
        )

    def test_fails_where_the_program_does(self):
        self.assertEqual(self.ask("echo 1; echo no mesh >&2; exit 3", "model([1, 2])"), "exit code 3: no mesh")
        self.assertIn("printed: no mesh", self.ask("echo no mesh", "model([1, 2])", ", read='out'"))
        for read in ("'out'", "lambda folder: 1"):
            said = self.ask("echo 1 2 > out; echo ERROR 42", "model([1, 2])", f", read={read}")
            self.assertIn("output reports an error: ERROR 42", said)
        self.assertIn("no numbers", self.ask("echo none", "model([1, 2])"))
        self.assertIn("0.2 s", self.ask("exec sleep 60", "model([1, 2])", ", seconds=0.2"))
        self.assertIn("0.2 s", self.ask("sleep 60; echo 1", "model([1, 2])", ", seconds=0.2"))
        for seconds in ("-1", "0", "float('nan')"):
            self.assertIn("positive", self.ask("true", f"isoline.command('true', 'in.tpl', seconds={seconds})"))

    def test_reads_numbers_as_programs_write_them(self):
        for printed, expected in (
            ("1.0D+00 -2d0 1.234-105", "[1.0, -2.0, 1.234e-105]"), ("steps 3 of 2nd kind", "[3.0]"),
            ("***** RESULTS *****", "no numbers"), ("1 1_000", "1_000"), ("head = ****", "overflow: ****"),
            ("3 *** 4", "overflow"), ("ERROR 42: no mesh", "ERROR 42"), ("Error: mesh 3", "Error: mesh"),
            ("error: 0.5", "[0.5]"), ("dose 0x10", "0x10"), ("٣ mol", "٣"),
            ("0.5x 2", "has '0.5x'"), ("10%\n2.5", "[2.5]"),
        ):
            self.assertIn(expected, self.ask(f"printf '%s' '{printed}'", "model([1, 2])"))

    def test_keeps_the_widths_of_templates_of_pest(self):
        self.TEMPLATE = "PTF #\n#  a   ##  b   #\n# A #\n"
        self.assertEqual(self.ask("true", "model.names"), "['a', 'b']")
        columns = "head -n 1 $1 | cut -c 1-8; head -n 1 $1 | cut -c 9-16; tail -n 1 $1"
        self.assertEqual(self.ask(columns, "model([1/3, -1e-10])"), "[0.3333333, -1e-10, 0.3333]")
        self.assertIn("width", self.ask("cat $1", "model([-1e-10, 1])"))
        self.assertIn("digits", self.ask("true", "model.note()"))
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "in.tpl"), "w") as file:
                file.write("~ a ~~ b ~\n")
            ran = subprocess.run(
                [sys.executable, "-c", "import isoline; isoline.command('true', 'in.tpl')"], cwd=folder,
                env=dict(os.environ, PYTHONPATH=CLIENT), capture_output=True, text=True,
            )
        self.assertIn("adjacent", ran.stderr)

    def test_reads_by_instructions_of_pest(self):
        self.TEMPLATE = "~ a ~\n"
        lines = ["pif @", "l1 !o1! !dum! !o2!", "@flow rate@ @=@ !q!", "l2 [a]3:8 (b)10:13", "l1 t5 !c! @=@ !d!",
                 "& !e!"]
        printed = ["1.0D0, 7 8", "skip", "xx flow rate = 5", "next", "  1.2500 -3.25e1", "abc 99 x=4 6"]
        program = "printf '%s\\n' " + " ".join(f"'{line}'" for line in printed)
        with tempfile.NamedTemporaryFile("w", suffix=".ins") as file:
            file.write("\n".join(lines))
            file.flush()
            said = self.ask(program, "model([1])", f", instructions={file.name!r}")
            self.assertEqual(said, "[1.0, 8.0, 5.0, 1.25, -32.5, 99.0, 4.0, 6.0]")
            self.assertIn("flow rate", self.ask("echo 1 2 3", "model([1])", f", instructions={file.name!r}"))

    def test_names_the_file_that_it_cannot_use(self):
        good = {"in.tpl": b"# \xb5 in Latin-1\n~ a ~\n", "out.ins": b"pif @\nl1 !y! \n"}
        for name, content, word in (
            ("in.tpl", b"~ \xb5 ~\n", "in.tpl"), ("out.ins", b"pif @\nl1 !dum!\n", "out.ins"),
            ("out.ins", b"pif @\n\xb5\n", "out.ins"), ("out.ins", b"pif @\n@k@ & !a!\n", "out.ins"),
            ("out.ins", b"pif @\nl1 [y]1:99999999999\n", "out.ins"),
            ("in.tpl", good["in.tpl"], "[2.5]"),
        ):
            with tempfile.TemporaryDirectory() as folder:
                for each, text in {**good, name: content}.items():
                    with open(os.path.join(folder, each), "wb") as file:
                        file.write(text)
                call = "isoline.command('tail -n 1 in.txt', 'in.tpl', instructions='out.ins')([2.5])"
                ran = subprocess.run(
                    [sys.executable, "-c", f"import isoline; print({call})"], cwd=folder,
                    env=dict(os.environ, PYTHONPATH=CLIENT), capture_output=True, text=True,
                )
            self.assertIn(word, (ran.stderr.strip() or ran.stdout).splitlines()[-1])

    def test_leaves_nothing_behind_when_it_is_killed(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "in.tpl"), "w") as file:
                file.write("~ a ~")
            with open(os.path.join(folder, "program.sh"), "w") as file:
                file.write("echo $$ > mark; sleep 600 & sleep 600\n")
            environment = dict(os.environ, PYTHONPATH=CLIENT, TMPDIR=folder)
            text = "import isoline\nisoline.command('sh program.sh', 'in.tpl', seconds=500)([1])"
            script = subprocess.Popen([sys.executable, "-c", text], cwd=folder, env=environment)
            until(lambda: [mark for mark in glob.glob(folder + "/isoline-*/mark") if os.path.getsize(mark)])
            with open(glob.glob(folder + "/isoline-*/mark")[0]) as file:
                group = int(file.read())
            script.kill()
            script.wait()
            until(lambda: not is_alive(group))
            until(lambda: not glob.glob(folder + "/isoline-*"))


def until(holds):
    end = time.monotonic() + 60
    while not holds():
        if time.monotonic() > end:
            raise AssertionError("waited too long")
        time.sleep(0.02)


def is_alive(group):
    """Whether any process of the group runs: those that ended may wait for their parent."""
    for name in os.listdir("/proc"):
        try:
            with open(f"/proc/{name}/stat") as file:
                fields = file.read().rsplit(")", 1)[1].split()
        except (OSError, IndexError):
            continue
        if int(fields[2]) == group and fields[0] != "Z":
            return True
    return False


class Optimizers(unittest.TestCase):
    has_numpy = True

    def answer(self, program, verb, count, numbers, status=0):
        asked, _, payload = program.receive()
        self.assertEqual((asked, len(payload)), (verb, 8 * count))
        program.send(verb, status, struct.pack(f"<{len(numbers)}d", *numbers))
        return list(struct.unpack(f"<{count}d", payload))

    def test_asks_in_the_vocabulary_of_the_wire(self):
        with Program(OPTIMIZER, self.has_numpy) as program:
            said = json.loads(program.greet("optimizer")[1])
            self.assertEqual(said["needs"], ["pullback", "jacobian"])
            self.assertTrue(said["reports"] and said["least_squares"])
            program.send(16, 0, struct.pack("<4d", 2, 3, 1, 2))
            self.assertEqual(self.answer(program, 17, 2, [7]), [1, 2])
            self.answer(program, 18, 2, [8, 9])
            self.answer(program, 19, 2, [7, 8, 9])
            self.answer(program, 21, 2, [1, 2, 3, 4, 5, 6])
            self.answer(program, 32, 2, [])
            verb, _, payload = program.receive()
            self.assertEqual((verb, payload), (34, b"done"))
            program.send(34, 0)
            self.assertEqual(self.answer(program, 33, 2, []), [5, 6])
            self.assertEqual(program.process.wait(), 0, "it left as it was meant to")

    def test_is_given_the_bounds_where_it_keeps_them(self):
        text = "import isoline\np = isoline.optimizer([], keeps_bounds=True)\n" \
            "p.finish([p.n, *p.x0, *p.lower, *p.upper])"
        infinity = float("inf")
        for bounds in ([-1, 0, 3, infinity], []):
            with Program(text, self.has_numpy) as program:
                self.assertTrue(json.loads(program.greet("optimizer")[1])["keeps_bounds"])
                begun = [2, 3, 1, 2] + bounds
                program.send(16, 0, struct.pack(f"<{len(begun)}d", *begun))
                expected = [2, 1, 2] + (bounds or [-infinity, -infinity, infinity, infinity])
                self.assertEqual(self.answer(program, 33, len(expected), []), expected)

    def test_leaves_quietly_when_told_to_stop(self):
        with Program(OPTIMIZER, self.has_numpy) as program:
            program.greet("optimizer")
            program.send(16, 0, struct.pack("<4d", 2, 3, 1, 2))
            self.answer(program, 17, 2, [], status=2)
            self.assertEqual(program.process.wait(), 0)
            self.assertEqual(program.process.stdout.read(), b"")


class OptimizersWithoutNumPy(Optimizers):
    has_numpy = False


@unittest.skipUnless(HAS_NUMPY, "NumPy is not installed")
class OptimizersWithNumPy(Optimizers):
    pass


del Optimizers


class Alone(unittest.TestCase):
    def test_a_script_without_isoline_says_how_to_start_it(self):
        environment = {k: v for k, v in os.environ.items() if k != "ISOLINE_FD"}
        for text in (PROBLEM % ALL, OPTIMIZER):
            found = subprocess.run(
                [sys.executable, "-c", text], env=dict(environment, PYTHONPATH=CLIENT),
                capture_output=True, text=True,
            )
            self.assertNotEqual(found.returncode, 0)
            self.assertIn("Isoline starts this script", found.stderr)

    def test_reads_data_without_numpy_and_says_what_a_fit_requires(self):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write("t,y,sigma\n1,2.5,0.1\n2,3.5,0.2\n")
            file.flush()
            text = WITHOUT_NUMPY + f"import isoline; data = isoline.read_data({file.name!r}); "
            texts = (text + "print(data['t'], data.y, data.sigma, data.x)", text + "isoline.fit(None, data, [1])")
            read, fit = (subprocess.run([sys.executable, "-c", each], env=dict(os.environ, PYTHONPATH=CLIENT),
                                        capture_output=True, text=True) for each in texts)
        self.assertEqual(read.stdout, "[1.0, 2.0] [2.5, 3.5] [0.1, 0.2] t\n", read.stderr)
        self.assertRegex(fit.stderr, "^isoline.fit requires NumPy")

    def test_a_damaged_report_or_array_is_named(self):
        line = {"name": "gd", "x": [1, 2], "y": [3, 4]}
        plot = {"name": "curve", "title": "", "x_label": "", "y_label": "", "join": "lines", "kind": "lines",
                "log_x": False, "log_y": True, "window": [0, 1, 1e-3, 1], "series": [line]}
        damages = [{"name": "../../curve"}, {"name": None}, {"window": [0, 1]}, {"window": [0, 1, 1, 1e-3]},
                   {"window": [0, 1, "inf", 1]}, {"series": [{**line, "y": [3]}]}, {"series": [{"x": 1}]},
                   {"title": "x" * 70_000}, {"goal": "nan"}, {"ends": [{"name": "start", "x": True}]}]
        texts = ["", "[", "[]", "{}", "[" * 60_000, b"\xb8"] + [json.dumps({"plots": [{**plot, **each}]}) for each in damages]
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "report.json")
            for text in [*texts, json.dumps({"plots": [plot]})]:
                with open(path, "wb") as file:
                    file.write(text if isinstance(text, bytes) else text.encode())
                found = subprocess.run([sys.executable, CLIENT + "/draw_figures.py", path, "--list"],
                                       capture_output=True, text=True, timeout=60, check=False)
                self.assertEqual(found.returncode, text in texts, found.stderr)
                self.assertEqual(found.stderr.startswith(path), text in texts, found.stderr)
                self.assertLessEqual(found.stderr.count("\n"), 1)
            os.mkdir(os.path.join(folder, "runs"))
            open(os.path.join(folder, "runs", "a.npy"), "w").close()
            for text in (b"", b"[]", b"{}", b"\xb8", b"[" * 60_000):
                with open(os.path.join(folder, "runs", "a.json"), "wb") as file:
                    file.write(text)
                found = subprocess.run([sys.executable, CLIENT + "/draw_figures.py", path, "--list", "--records", folder],
                                       capture_output=True, text=True, timeout=60, check=False)
                self.assertRegex(found.stderr, "^left out: .*a.npy")
                self.assertEqual(found.returncode, 0, found.stderr)
            array = os.path.join(folder, "x.npy")
            for data in (b"", b"\x93NUMPY\1\0\4\0{'a'", b"\x93NUMPY\1\0\2\0\0\0"):
                with open(array, "wb") as file:
                    file.write(data)
                found = subprocess.run([sys.executable, CLIENT + "/umbridge.py", "model", "--start", array, "--target", "[1]"],
                                       capture_output=True, text=True, timeout=60, check=False)
                self.assertIn(array + " must be", found.stderr)
                self.assertNotIn("Traceback", found.stderr)

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_draws_a_path_that_leaves_the_window_for_good(self):
        line = {"name": "gd", "x": [0, 0.5, 1e15], "y": [0, 0.5, -1e15], "marker": "o"}
        plot = {"name": "path", "title": "", "x_label": "", "y_label": "", "join": "lines", "kind": "path",
                "log_x": False, "log_y": False, "window": [0, 1, 0, 1], "series": [line]}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "report.json")
            with open(path, "w") as file:
                json.dump({"plots": [plot]}, file)
            found = subprocess.run([sys.executable, CLIENT + "/draw_figures.py", path, "--out", folder],
                                   capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual(found.returncode, 0, found.stderr[-400:])


if __name__ == "__main__":
    unittest.main()
