"""What UM-Bridge 1.0 asks of a server, by an independent client: sizes, types and errors of every
verb, for every model that is served."""

import signal
import subprocess
import sys
import unittest

import served

PROBLEMS = ["rosenbrock", "sine[xi=32]", "heat[N=8]", "brown-dennis"]
VERBS = ["Evaluate", "Gradient", "ApplyJacobian", "ApplyHessian"]


def is_error(answer, kind):
    error = answer.get("error", {})
    return set(answer) == {"error"} and set(error) == {"type", "message"} and \
        error["type"] == kind and isinstance(error["message"], str) and error["message"] != ""


def call_of(verb, name, sizes, value=0.5):
    """A good call of that verb at the first input and output."""
    inputs, outputs = sizes
    members = {"name": name, "input": [[value] * size for size in inputs], "config": {}}
    if verb != "Evaluate":
        members["outWrt"] = 0
    if verb in ("Gradient", "ApplyJacobian"):
        members["inWrt"] = 0
    if verb == "ApplyHessian":
        members |= {"inWrt1": 0, "inWrt2": 0}
    if verb in ("Gradient", "ApplyHessian"):
        members["sens"] = [1.0] * outputs[0]
    if verb in ("ApplyJacobian", "ApplyHessian"):
        members["vec"] = [1.0] * (inputs[0] if inputs else 1)
    return members


class Protocol(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.models = cls.enterClassContext(served.serving(sys.argv[1], *PROBLEMS))

    def every_model(self):
        for name in self.models.info()["models"]:
            sizes = (self.models.ask("/InputSizes", name=name, config={})[1]["inputSizes"],
                     self.models.ask("/OutputSizes", name=name)[1]["outputSizes"])
            support = self.models.ask("/ModelInfo", name=name)[1]["support"]
            with self.subTest(model=name):
                yield name, sizes, support

    def test_info_names_the_protocol_and_the_models(self):
        info = self.models.info()
        self.assertEqual(set(info), {"protocolVersion", "models"})
        self.assertEqual(info["protocolVersion"], 1.0)
        for problem in PROBLEMS:
            for suffix in ["", ".loss", ".data"]:
                self.assertIn(problem + suffix, info["models"])
        self.assertIn("rosenbrock.inverse", info["models"])
        self.assertNotIn("brown-dennis.inverse", info["models"])

    def test_sizes_and_support_have_the_protocols_types(self):
        for _, (inputs, outputs), support in self.every_model():
            self.assertTrue(all(isinstance(size, int) and size > 0 for size in inputs + outputs))
            self.assertEqual(sorted(support), sorted(VERBS))
            self.assertTrue(all(isinstance(has, bool) for has in support.values()))
            self.assertTrue(support["Evaluate"])

    def test_answers_have_the_sizes_that_were_promised(self):
        for name, (inputs, outputs), support in self.every_model():
            status, answer = self.models.ask("/Evaluate", **call_of("Evaluate", name,
                                                                    (inputs, outputs)))
            if name.endswith(".inverse"):  # there may be none for this y
                continue
            self.assertEqual((status, set(answer)), (200, {"output"}), answer)
            self.assertEqual([len(part) for part in answer["output"]], outputs)
            for verb, size in [("Gradient", inputs), ("ApplyJacobian", outputs),
                               ("ApplyHessian", inputs)]:
                if not support[verb]:
                    continue
                status, answer = self.models.ask(f"/{verb}", **call_of(verb, name,
                                                                       (inputs, outputs)))
                self.assertEqual(status, 200, f"{verb}: {answer}")
                self.assertEqual(len(answer["output"]), size[0])
                self.assertTrue(all(isinstance(value, float) for value in answer["output"]))

    def test_an_unknown_model_is_not_found(self):
        for path in ["InputSizes", "OutputSizes", "ModelInfo", *VERBS]:
            status, answer = self.models.ask(f"/{path}", name="wrong_model_name")
            self.assertEqual(status, 400)
            self.assertTrue(is_error(answer, "ModelNotFound"), answer)

    def test_what_is_not_supported_is_said_before_the_input_is_looked_at(self):
        seen = set()
        for name, _, support in self.every_model():
            for verb in VERBS:
                if support[verb]:
                    continue
                seen.add(verb)
                status, answer = self.models.ask(f"/{verb}", name=name)
                self.assertEqual(status, 400)
                self.assertTrue(is_error(answer, "UnsupportedFeature"), answer)
        self.assertEqual(seen, {"Gradient", "ApplyJacobian", "ApplyHessian"})

    def test_inputs_of_other_sizes_are_invalid(self):
        for name, sizes, support in self.every_model():
            for verb in VERBS:
                if not support[verb]:
                    continue
                good = call_of(verb, name, sizes)
                wrong = [good | {"input": good["input"] + [[1.0]]},
                         good | {"input": [part + [1.0] for part in good["input"]] or [[1.0]]}]
                for key in ["outWrt", "inWrt", "inWrt1", "inWrt2"]:
                    if key in good:
                        wrong += [good | {key: 1}, good | {key: -1}, good | {key: "0"}]
                for key in ["sens", "vec"]:
                    if key in good:
                        wrong += [good | {key: good[key] + [0.0]}, good | {key: []}]
                for members in wrong:
                    status, answer = self.models.ask(f"/{verb}", **members)
                    self.assertEqual(status, 400, f"{verb} {members}")
                    self.assertTrue(is_error(answer, "InvalidInput"), answer)

    def test_numbers_are_the_functions_own(self):
        x = [-1.2, 1.0]
        (y,) = self.models.evaluate("rosenbrock", [x])
        self.assertAlmostEqual(y[0], 10 * (x[1] - x[0] * x[0]), delta=1e-14)  # x1² may be fused
        self.assertEqual(y[1], 1 - x[0])
        self.assertEqual(self.models.gradient("rosenbrock", [x], [1.0, 0.0]), [-20 * x[0], 10.0])
        self.assertEqual(self.models.evaluate("rosenbrock.data", []), [[0.0, 0.0], x])
        loss = self.models.evaluate("rosenbrock.loss", [x])[0][0]
        slope = self.models.gradient("rosenbrock.loss", [x], [1.0])
        for i, step in enumerate([1e-6, 1e-6]):
            moved = list(x)
            moved[i] += step
            there = self.models.evaluate("rosenbrock.loss", [moved])[0][0]
            self.assertAlmostEqual((there - loss) / step, slope[i], delta=1e-2)

    def test_the_hessian_is_the_slope_of_the_gradient(self):
        x, step, v = [-1.2, 1.0], 1e-6, [0.3, -0.7]
        moved = [x[i] + step * v[i] for i in range(2)]
        for name, sens in [("rosenbrock.loss", [2.0]), ("rosenbrock", [1.5, -0.5])]:
            here = self.models.gradient(name, [x], sens)
            there = self.models.gradient(name, [moved], sens)
            _, answer = self.models.ask("/ApplyHessian", name=name, input=[x], sens=sens, vec=v,
                                        outWrt=0, inWrt1=0, inWrt2=0)
            for i in range(2):
                self.assertAlmostEqual(answer["output"][i], (there[i] - here[i]) / step, delta=1e-2)

    def test_what_is_not_finite_is_read_by_pythons_json(self):
        values = self.models.evaluate("brown-dennis", [[1e200, 1e200, 1.0, 1.0]])[0]
        self.assertTrue(any(value in (float("inf"), float("-inf")) or value != value
                            for value in values), values)


class Endings(unittest.TestCase):
    def test_each_signal_ends_it_well(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process = subprocess.Popen([sys.argv[1], "serve", "square"], stdout=subprocess.PIPE,
                                       text=True)
            self.assertIn("serving 3 models at http://127.0.0.1:",
                          process.stdout.readline().replace("4 models", "3 models"))
            process.send_signal(number)
            self.assertEqual(process.wait(served.PATIENCE), 0)
            process.stdout.close()

    def test_the_environment_says_the_port(self):
        with served.serving(sys.argv[1], "square") as models:
            taken = models.port
            run = subprocess.run([sys.argv[1], "serve", "square", "--host", "999.1.1.1", "--port",
                                  taken], capture_output=True, text=True, check=False)
            self.assertEqual(run.returncode, 1)
            self.assertIn("nothing can listen at 999.1.1.1", run.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
