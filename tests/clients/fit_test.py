"""isoline.fit as a person calls it, with the built program. fit_test.py ISOLINE CLIENTS

Expected values are those of lmfit 1.1.0 (leastsq with ftol = xtol = 1e-15, conf_interval), or certified by NIST."""

import json
import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import xml.etree.ElementTree

os.environ["ISOLINE"], CLIENTS = os.path.abspath(sys.argv[1]), sys.argv[2]
del sys.argv[1:3]
sys.path.insert(0, CLIENTS)
try:
    import numpy
except ImportError:
    print("isoline.fit requires NumPy, which this Python does not have")
    sys.exit(77)
import isoline  # noqa: E402

try:
    import pandas
except ImportError:
    pandas = None

MISRA_X = [77.6, 114.9, 141.1, 190.8, 239.9, 289, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760]
MISRA_Y = [10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.4, 75.47, 81.78]
PPM = [0.02, 0.02, 0.06, 0.06, 0.11, 0.11, 0.22, 0.22, 0.56, 0.56, 1.10, 1.10]
HOURS = [0, 0.25, 0.57, 1.12, 2.02, 3.82, 5.1, 7.03, 9.05, 12.12, 24.37]
VOLTS = [-0.2057, -0.1291, -0.0588, 0.0057, 0.0646, 0.1185, 0.1678, 0.2132, 0.2545, 0.2924, 0.3269, 0.3585, 0.3873,
         0.4137, 0.4373, 0.4590, 0.4784, 0.4960, 0.5119, 0.5265, 0.5398, 0.5521, 0.5633, 0.5736, 0.5833, 0.5900]


def misra(b):  # NIST, Misra1a
    return [b[0] * (1 - math.exp(-b[1] * x)) for x in MISRA_X]


def puromycin(x):  # Treloar (1974), in Bates, Watts (1988)
    return [x[0] * c / (x[1] + c) for c in PPM]


def theophylline(x):  # Boeckmann, Sheiner, Beal (1994), subject 1
    ka, clearance, volume, lag = x
    k, after = clearance / volume, [max(t - lag, 0.0) for t in HOURS]
    return [4.02 * ka / volume * (math.exp(-k * t) - math.exp(-ka * t)) / (ka - k) for t in after]


def solar_cell(x):  # Easwarakhanthan et al. (1986)
    photo, saturation, ideality, series, shunt = x
    thermal, y = ideality * 8.617333262e-5 * 306.15, []
    for volt in VOLTS:
        current = photo + abs(volt) / shunt
        for _ in range(300):
            drop = volt + current * series
            diode = saturation * math.exp(drop / thermal)
            move = (photo - diode + saturation - drop / shunt - current) / (1 + diode * series / thermal + series / shunt)
            current += move
            if abs(move) < 1e-13:
                break
        y.append(current)
    return y


def boarding_school(x):  # British Medical Journal, 4 March 1978: boys in bed on each day, by a model of an epidemic
    beta, gamma, infected = x
    s, y = [763 - infected, infected], []
    rates = lambda s: (-beta * s[0] * s[1] / 763, beta * s[0] * s[1] / 763 - gamma * s[1])
    for step in range(280):
        a = rates(s)
        b = rates([p + 0.025 * q for p, q in zip(s, a)])
        c = rates([p + 0.025 * q for p, q in zip(s, b)])
        d = rates([p + 0.05 * q for p, q in zip(s, c)])
        s = [s[i] + 0.05 / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]) for i in (0, 1)]
        if step % 20 == 19:
            y.append(s[1])
    return y


def lubricant(x):  # Yasuda et al. (1981), with an Arrhenius shift
    zero, infinite, relaxation, width, n, energy = x
    shifts = [math.exp(energy / 8.31446261815324 * (1 / kelvin - 1 / 313.15)) for kelvin in (303.15, 313.15, 323.15)]
    return [infinite + (zero * shift - infinite) * (1 + (relaxation * shift * shear) ** width) ** ((n - 1) / width)
            for shift in shifts for shear in (4e7, 7e7, 1e8, 2e8, 4e8, 7e8, 1e9, 2e9)]


# forward, data, arguments of fit, x, sd, correlations of the first with the others, profile intervals
CALIBRATIONS = {
    "misra1a": (misra, MISRA_Y, {"x0": [500, 1e-4]}, [238.94212918, 5.5015643181e-4], [2.7070075241, 7.2668688436e-6],
                [-0.9988], [[233.195, 245.017], [0.000534318, 0.00056603]]),
    "puromycin": (puromycin, [76, 47, 97, 107, 123, 139, 159, 152, 191, 201, 207, 200], {"x0": [100, 1]},
                  [212.683743, 0.0641212817], [6.9472, 0.008281], [0.7651], [[197.302, 229.289], [0.0469203, 0.0861569]]),
    "theophylline": (theophylline, [0.74, 2.84, 6.57, 10.5, 9.66, 8.58, 8.36, 7.47, 6.89, 5.94, 3.28],
                     {"x0": [0.7, 0.1, 1, 0.05], "bounds": ([0, 1e-3, 1e-2, 0], [math.inf] * 3 + [1])},
                     [2.66515375, 0.0194208159, 0.377394258, 0.140826957], [0.57666, 0.0018811, 0.016105, 0.038689],
                     [-0.3542, 0.5868, 0.755], [[1.7186, 4.21882], [0.015105, 0.0240289], [0.341779, 0.415461], [0.0233032, 0.204948]]),
    "solar-cell": (solar_cell, [0.7640, 0.7620, 0.7605, 0.7605, 0.7600, 0.7590, 0.7570, 0.7570, 0.7555, 0.7540, 0.7505, 0.7465,
                                0.7385, 0.7280, 0.7065, 0.6755, 0.6320, 0.5730, 0.4990, 0.4130, 0.3165, 0.2120, 0.1035, -0.0100,
                                -0.1230, -0.2100],
                   {"x0": [0.8, 1e-6, 1.5, 0.05, 100], "bounds": ([0, 0, 0.1, 0, 0.1], [1, math.inf, 5, 0.5, math.inf]), "log": ["x2"]},
                   [0.76078797, 3.1068459e-07, 1.4772693, 0.036546945, 52.889789], [0.00032171, 3.3472e-08, 0.010802, 0.00049257, 3.9512],
                   [-0.1214, -0.1195, 0.0824, -0.6401],
                   [[0.760119, 0.761457], [2.47369e-07, 3.88299e-07], [1.45477, 1.49997], [0.035516, 0.0375758], [45.7746, 62.6607]]),
}
# Pa s, synthetic: at three temperatures and eight shear rates
VISCOSITY = [0.0318619, 0.0236786, 0.0194568, 0.0133373, 0.00914138, 0.00670503, 0.00552466, 0.00376826, 0.0266442, 0.019656,
             0.0162281, 0.0111088, 0.00763982, 0.00560483, 0.00462316, 0.00315254, 0.0221819, 0.0167061, 0.0137524, 0.00943234,
             0.0064389, 0.0047677, 0.00391665, 0.00265948]
BOYS = [3, 8, 26, 76, 225, 298, 258, 233, 189, 128, 68, 29, 14, 4]


class Fits(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())

    def fit(self, *arguments, **more):
        return isoline.fit(*arguments, **{"out": self.folder + "/results", "progress": False, **more})

    def records(self, out=None):
        folder = (out or self.folder + "/results") + "/runs/"
        for each in os.listdir(folder):
            with open(folder + each) as file:
                yield json.load(file)

    def record(self, out=None):
        return next(self.records(out))

    def assertNear(self, found, expected, relative):
        self.assertEqual(len(found), len(expected))
        for a, b in zip(found, expected):
            self.assertLessEqual(abs(a - b), relative * abs(b), (list(found), list(expected)))

    def test_agrees_with_other_programs(self):
        for name, (forward, data, given, x, sd, correlations, intervals) in CALIBRATIONS.items():
            with self.subTest(name):
                result = self.fit(forward, data, **given)
                self.assertEqual((result.status, result.message), ("converged", ""))
                self.assertLessEqual(max(abs(a - b) / s for a, b, s in zip(result.x, x, sd)), 0.01)
                self.assertNear(result.sd, sd, 0.01)
                for found, expected in zip(result.correlation[0][1:], correlations):
                    self.assertLessEqual(abs(found - expected), 0.01)
                profile = result.profile()
                self.assertEqual(profile.messages, [])
                for found, (low, high) in zip(profile.interval, intervals):
                    miss = max(abs(found[0] - low), abs(found[1] - high))
                    self.assertLessEqual(miss, 0.02 * (high - low) / 2, list(found))

    def test_holds_an_unknown_at_its_bound(self):
        result = self.fit(boarding_school, BOYS, [1, 0.2, 5], bounds=([0, 0, 1], [10, 5, 100]), names=["beta", "gamma", "infected"])
        self.assertNear(result.x, [1.66922622, 0.4434502, 1], 1e-6)
        self.assertNear(result.sd[:2], [0.02571, 0.01557], 0.01)  # of SciPy, with infected = 1; else 0.104 and 0.0197
        self.assertTrue(math.isnan(result.sd[2]))
        self.assertEqual(result.degrees_of_freedom, 12)
        self.assertIn("infected", result.message)
        profile = result.profile()
        self.assertEqual(profile.interval[2][0], 1)
        self.assertIn("infected", profile.messages[0])
        # the roots of S = S_min (1 + t²/ν), with S minimized within the bounds by SciPy 1.10.1 (TRF)
        ends = [1.54863, 1.72494, 0.411735, 0.478913, 1, 1.73308]
        self.assertNear([each for row in profile.interval for each in row], ends, 0.001)

    def test_profiles_a_curved_valley_beside_bounds(self):  # a linear step leads to relaxation = 0, where y does not change
        result = self.fit(lubricant, VISCOSITY, [0.05, 1e-3, 1e-6, 2, 0.6, 2e4], sigma=[0.003 * y for y in VISCOSITY],
                          bounds=([0, 0, 0, 0.1, 0, 0], [math.inf] * 3 + [10, 1, math.inf]))
        self.assertAlmostEqual(result.x[3], 1.94646, delta=1e-4)
        profile = result.profile(["x4"])
        self.assertAlmostEqual(profile.interval[0][1], 5.5572, delta=0.05)  # of nested fits by SciPy 1.10.1 (TRF)
        self.assertEqual(profile.messages, [])

    def test_needs_no_file_for_a_closure_and_makes_no_call_twice(self):
        calls = []

        def forward(x):
            calls.append(threading.current_thread())
            return misra(x)

        first = self.fit(forward, MISRA_Y, [500, 1e-4])
        self.assertEqual(set(calls), {threading.main_thread()})
        self.assertGreaterEqual(len(calls), first.work)
        self.assertLessEqual(len(calls), first.work + 20)  # of the checks and the measurement of a call's time
        calls.clear()
        second = self.fit(forward, MISRA_Y, [500, 1e-4])
        self.assertEqual(list(second.x), list(first.x))
        self.assertLessEqual(len(calls), 12)  # to see that forward is still the same
        self.fit(forward, [y + 1 for y in MISRA_Y], [500, 1e-4])
        self.assertGreater(len(calls), 20)

    def test_is_made_again_where_what_forward_uses_has_changed(self):
        t, fits = numpy.linspace(0, 1, 20), []
        for power in (1, 2, 1):  # at x0, both are zero
            basis = t**power

            def forward(b):
                return b[0] + b[1] * basis

            fits.append(self.fit(forward, 1 + 2 * t, [0, 0]))
            least = numpy.linalg.lstsq(numpy.c_[numpy.ones(20), basis], 1 + 2 * t, rcond=None)[0]
            self.assertTrue(numpy.allclose(fits[-1].x, least, rtol=1e-6), (power, fits[-1].x, least))
            self.assertTrue(numpy.allclose(fits[-1].y, forward(fits[-1].x)))

    def test_of_a_script_is_made_again_where_its_data_have_changed(self):
        script, data = self.folder + "/line.py", self.folder + "/data.csv"
        with open(script, "w") as file:
            file.write(f"import isoline\ndata = isoline.read_data({data!r})\n"
                       "isoline.problem(lambda b: [b[0] + b[1] * t for t in data['t']], start=[1, 1], target=data.y)\n")
        words = ["run", "--problem", f"process[command=\"{sys.executable} {script}\"]", "--optimizer", "levenberg-marquardt"]
        for last, reused in ((2, 0), (2, 1), (5, 0)):
            with open(data, "w") as file:
                file.write(f"t,y\n0,1\n1,3\n2,{last}\n")
            ran = subprocess.run([os.environ["ISOLINE"], *words, "--out", self.folder + "/results", "--no-report"],
                                 env=dict(os.environ, PYTHONPATH=CLIENTS), capture_output=True, text=True)
            self.assertIn(f"{reused} reused", ran.stdout, ran.stderr)
            self.assertEqual("other data" in ran.stderr, last == 5, ran.stderr)

    def test_lists_the_methods_that_are_asked_for_alone(self):
        first = self.fit(misra, MISRA_Y, [500, 1e-4])
        other = self.fit(misra, MISRA_Y, [500, 1e-4], methods="nlopt-neldermead")
        self.assertEqual([method for method, *_ in first.runs], ["levenberg-marquardt[jacobian=differences]"])
        self.assertEqual([method for method, *_ in other.runs], ["nlopt-neldermead"])
        with self.assertRaisesRegex(isoline.Refused, "nosuch"):
            self.fit(misra, MISRA_Y, [500, 1e-4], methods="nosuch")

    def test_raises_what_forward_raises_at_the_start(self):
        with self.assertRaises(ZeroDivisionError):
            self.fit(lambda x: [1 / 0, 1], [1, 2], [0])

    def test_survives_failed_calls(self):
        def forward(x):
            if x[1] > 0.3 and x[0] < 99:
                raise RuntimeError("no mesh")
            return puromycin(x)

        _, data, given, x, sd, *_ = CALIBRATIONS["puromycin"]
        self.assertNear(self.fit(forward, data, **given).x, x, 1e-6)

    def test_a_call_that_fails_by_chance_when_it_is_verified_is_made_again(self):
        seen = {}

        def forward(x):
            seen[tuple(x)] = seen.get(tuple(x), 0) + 1
            if seen[tuple(x)] == 2 and tuple(x) != (100, 1):
                raise RuntimeError("no licence")
            return [x[0] * c / (x[1] + c) for c in PPM]

        result = self.fit(forward, CALIBRATIONS["puromycin"][1], [100, 1])
        self.assertEqual(result.status, "converged", result.message)
        self.assertEqual(self.record()["calls"]["failed"], 1)

    def test_a_script_that_fails_here_and_there_passes_its_checks(self):
        script = self.folder + "/script.py"
        with open(script, "w") as file:
            file.write("import isoline, struct, sys, zlib\n"
                       f"ppm, salt, factor = {PPM}, *map(float, sys.argv[1:])\n"
                       "def forward(x):\n"
                       "    if zlib.crc32(struct.pack('3d', *x, salt)) % 10 == 0:\n"
                       "        raise RuntimeError('no mesh')\n"
                       "    return [x[0] * c / (x[1] + c) for c in ppm]\n"
                       "def vjp(x, w):\n"
                       "    return [factor * sum(v * c / (x[1] + c) for v, c in zip(w, ppm)),\n"
                       "            factor * sum(-v * x[0] * c / (x[1] + c) ** 2 for v, c in zip(w, ppm))]\n"
                       "given = {'vjp': vjp} if factor else {'differences': True}\n"
                       "isoline.problem(forward, start=[100, 1], start_scale='own', target=[100.0] * 12, **given)\n")
        for words, code in (("1 0", 0), ("2 0", 0), ("2 1", 0), ("3 1", 0), ("2 1.1", 2)):  # salt, factor of vjp
            ran = subprocess.run([os.environ["ISOLINE"], "check", f"process[command=\"{sys.executable} {script} {words}\"]"],
                                 capture_output=True, text=True, timeout=120)
            self.assertEqual(ran.returncode, code, words + ran.stdout + ran.stderr)

    def test_has_no_uncertainty_without_a_fit(self):
        flat = self.fit(lambda x: misra(x[:2]), MISRA_Y, [500, 1e-4, 1], names=["a", "b", "idle"])
        few = self.fit(misra, MISRA_Y, [500, 1e-4], methods="nlopt-neldermead", work=20)
        contradicted = self.fit(misra, MISRA_Y, [500, 1e-4], sigma=0.01)
        self.assertEqual(len(flat.runs), 3)
        self.assertEqual(len({record["request"]["problem"]["spec"] for record in self.records()}), 3, "one for each fit")
        for result, word in ((flat, "idle"), (few, "budget"), (contradicted, "χ²")):
            self.assertEqual((result.sd, result.interval, result.correlation), (None, None, None))
            self.assertIn(word, result.message)
            with self.assertRaises(isoline.Refused):
                result.profile()
        with self.assertRaisesRegex(isoline.Refused, "nosuch"):
            self.fit(misra, MISRA_Y, [500, 1e-4]).profile(["x1", "nosuch"])
        self.assertLess(contradicted.p, 1e-3)
        self.assertAlmostEqual(self.fit(misra, MISRA_Y, [500, 1e-4], sigma=0.1).p, 0.41, delta=0.005)

    def test_knows_fixed_and_tied_unknowns_and_priors(self):
        line = lambda x: [x[0] + x[1] * t for t in (0, 1, 2, 3)]
        data = [1.1, 2.9, 5.2, 6.8]
        fixed = self.fit(line, data, {"a": 0, "b": 1}, fixed={"a": 1})
        self.assertNear(fixed.x, [1, 27.7 / 14], 1e-9)  # Σ t (y − 1) / Σ t²
        self.assertTrue(math.isnan(fixed.sd[0]))
        tied = self.fit(line, data, {"a": 0, "b": 1}, tied={"a": "b / 2"})
        slope = sum((t + 0.5) * y for t, y in enumerate(data)) / 21  # Σ (t + ½)² = 21
        self.assertNear(tied.x, [slope / 2, slope], 1e-9)
        self.assertAlmostEqual(tied.sd[0], tied.sd[1] / 2, delta=1e-6)
        # the normal equations: sums of 1/σ² [1 t; t t²], with 1/sd² of the prior added to that of b
        prior = self.fit(line, data, {"a": 0, "b": 1}, sigma=0.5, prior={"b": (1, 0.1)})
        weight = 4.0
        a11, a12, a22 = 4 * weight, 6 * weight, 14 * weight + 100
        b1, b2 = weight * sum(data), weight * sum(t * y for t, y in enumerate(data)) + 100
        determinant = a11 * a22 - a12**2
        self.assertNear(prior.x, [(a22 * b1 - a12 * b2) / determinant, (a11 * b2 - a12 * b1) / determinant], 1e-8)
        with self.assertRaises(isoline.Refused):
            self.fit(line, data, {"a": 0, "b": 1}, prior={"b": (1, 0.1)})

    def test_unknowns_that_are_tied_have_bounds_and_names_of_any_kind(self):
        line = lambda x: [abs(x[0]) + x[1] * t for t in (0, 1, 2, 3)]
        data, x0 = [1.1, 2.9, 5.2, 6.8], {"a": -1, "lambda": 1}
        tied = self.fit(line, data, x0, tied={"a": "-abs(lambda) / 2"})
        slope = sum((t + 0.5) * y for t, y in enumerate(data)) / 21
        self.assertNear(tied.x, [-slope / 2, slope], 1e-9)
        limited = self.fit(line, data, x0, tied={"a": "-lambda / 2"}, bounds=([-0.9, 0], [9, 9]))
        self.assertGreaterEqual(limited.x[0], -0.9)
        self.assertGreater(limited.loss, 1.01 * tied.loss)
        with self.assertRaisesRegex(isoline.Refused, "a is -1"):
            self.fit(line, data, x0, fixed=["a"], bounds=([0, 0], [9, 9]))

    def test_counts_no_degree_of_freedom_for_what_a_bound_holds(self):
        curve = lambda x: [x[0] + x[1] * t + x[2] * t**2 for t in (0, 1, 2)]
        result = self.fit(curve, [1.1, 2.9, 5.2], [1, 1, 1], bounds=([-9, -9, 0.5], [9, 9, 9]))
        self.assertEqual((result.status, result.degrees_of_freedom), ("converged", 1))
        self.assertGreater(result.sd[0], 0)

    def test_weights_are_factors_of_residuals_without_a_scale(self):
        line = lambda x: [x[0] + x[1] * t for t in (0, 1, 2, 3)]
        data, sigma = [1.1, 2.9, 5.2, 6.8], [0.1, 0.2, 0.4, 0.8]
        known = self.fit(line, data, {"a": 0, "b": 1}, sigma=sigma)
        weighted = self.fit(line, data, {"a": 0, "b": 1}, weights=[3 / each for each in sigma])
        self.assertNear(weighted.x, known.x, 1e-8)
        self.assertNear(weighted.sd, known.sd, 1e-6)  # by the residuals in both
        self.assertAlmostEqual(weighted.loss, 9 * known.loss, delta=1e-6 * weighted.loss)
        self.assertIsNone(weighted.p)
        with self.assertRaises(isoline.Refused):
            self.fit(line, data, {"a": 0, "b": 1}, weights=[1, 1, 1, 1], sigma=1)

    def test_names_the_minima_of_several_starts(self):
        result = self.fit(lambda x: [x[0] ** 2 - 4, 0.5 * (x[0] - 2)], [0, 0], [-1], bounds=(-3, 3), starts=5)
        self.assertEqual(sum(count for count, _, _ in result.basins), 5)
        self.assertEqual(len(result.basins), 2)
        self.assertAlmostEqual(result.x[0], 2, delta=1e-6)
        self.assertLess(result.basins[1][2][0], -1.5)
        with self.assertRaises(isoline.Refused):
            self.fit(misra, MISRA_Y, [500, 1e-4], starts=2)

    def test_says_what_limits_a_profile(self):
        t = [1, 2, 3, 4, 5, 6]
        bent = [0.98, 2.0, 2.93, 3.98, 4.85, 5.85]  # nearly a line, which any large value of half gives
        result = self.fit(lambda x: [x[0] * s / (1 + s / max(x[1], 1e-9)) for s in t], bent, [1, 50], names=["slope", "half"],
                          bounds=(0, math.inf))
        profile = result.profile(["half"])
        self.assertEqual(list(profile.names), ["half"])
        self.assertEqual(profile.interval[0][1], math.inf)
        self.assertNear(profile.interval[0][:1], [69.28], 0.01)
        self.assertIn("half", profile.messages[0])

        parabola = lambda x: [x[0] * s + x[1] * s * s for s in t]
        data = [1.2, 1.9, 3.3, 3.8, 5.2, 5.9]
        free = self.fit(parabola, data, [1, 0], names=["a", "b"])
        most = free.x[1] + 0.2 * free.sd[1]
        held = self.fit(parabola, data, [1, free.x[1]], names=["a", "b"], bounds=([-9, -9], [9, most]))
        profile = held.profile(["a"])
        self.assertGreater(profile.interval[0][0], free.profile(["a"]).interval[0][0])  # narrower
        self.assertTrue(any("lower limit" in each and "b at a bound" in each for each in profile.messages), profile.messages)

        def forward(x):
            if x[0] > 2.68:
                raise RuntimeError("no mesh")
            return [x[0] * s for s in t]

        profile = self.fit(forward, [2.5, 5.3, 7.4, 11, 13.1, 16.2], [1], names=["slope"]).profile()
        self.assertNear(profile.interval[0], [2.5668, 2.68], 1e-3)
        self.assertIn("no value at slope", profile.messages[0])

        # b is held at 0, beside a bound at infinity: S(b) = S_min − 2 b c + b² d, by the sums below
        t, data = [0, 1, 2, 3], [4.1, 3.6, 3.9, 3.4]
        held = self.fit(lambda x: [x[0] + 1e6 * x[1] * s for s in t], data, [3, 1e-7], names=["a", "b"], bounds=(0, math.inf))
        profile = held.profile(["b"])
        mean = sum(data) / 4
        c, d = (1e6 * sum((s - 1.5) * (y - mean) for s, y in zip(t, data)), 1e12 * 5)
        rise = 2 * held.loss * 3.1824463**2 / 3
        self.assertEqual(profile.interval[0][0], 0)
        self.assertAlmostEqual(profile.interval[0][1] / ((c + math.sqrt(c * c + d * rise)) / d), 1, delta=0.01)

    def test_records_have_its_words_and_the_axis_of_its_data(self):
        path = self.folder + "/misra.csv"
        with open(path, "w") as file:
            file.write("t,height,e\n" + "".join(f"{x},{y},0.1\n" for x, y in zip(MISRA_X, MISRA_Y)))
        result = self.fit(misra, isoline.read_data(path, y="height", sigma="e"), {"b1": 500, "b2": 1e-4}, log=["b2"],
                          fixed={"b1": 240}, prior={"b2": (5e-4, 1e-4)})
        record = self.record()
        options = record["request"]["problem"]["options"]
        self.assertEqual((options["log"], options["fixed"]), ("b2", "b1=240.0"))
        self.assertTrue(options["axis"].startswith("t; height; 77.6; 114.9"), options["axis"])
        self.assertIn("b2 = 0.0005", options["prior"])
        self.assertNear(record["fit"]["target"], MISRA_Y, 1e-15)
        self.assertEqual(record["fit"]["sigma"], [0.1] * 14)
        self.assertNear(record["answer"]["x"][0], result.x, 1e-12)

    def test_a_script_has_the_same_words(self):
        path, script = self.folder + "/misra.csv", self.folder + "/script.py"
        with open(path, "w") as file:
            file.write("t,y\n" + "".join(f"{x},{y}\n" for x, y in zip(MISRA_X, MISRA_Y)))
        with open(script, "w") as file:
            file.write("import isoline, math\n"
                       f"isoline.problem(lambda b: [b[0] * (1 - math.exp(-b[1] * x)) for x in {MISRA_X}], start=[240, 1e-4],\n"
                       f"                target={path!r}, names=['b1', 'b2'], log=['b2'], fixed=['b1'],\n"
                       f"                sigma=isoline.option('deviation', 0.1))\n")
        fixed = self.fit(misra, MISRA_Y, {"b1": 240, "b2": 1e-4}, log=["b2"], fixed=["b1"], sigma=0.1)
        for sigma, loss in (("", fixed.loss), (",sigma=0.2", fixed.loss / 4), (",deviation=0.2", fixed.loss / 4)):
            out = f"{self.folder}/script{sigma}"
            ran = subprocess.run(
                [os.environ["ISOLINE"], "run", "--problem", f"process[command=\"{sys.executable} {script}\"{sigma}]", "--optimizer",
                 "levenberg-marquardt", "--uncertified", "--no-report", "--out", out], capture_output=True, text=True, timeout=60)
            self.assertEqual(ran.returncode, 0, ran.stderr)
            record = self.record(out)
            self.assertAlmostEqual(record["summary"]["loss"] / loss, 1, delta=1e-6)
            self.assertNear(record["answer"]["x"][0], fixed.x, 1e-5)
            self.assertEqual(record["request"]["problem"]["options"]["log"], "b2")

    def test_digits_show_behind_deviations_where_calls_fail_and_a_bound_holds(self):
        """An exponential of six digits, a tenth of whose calls fail; c ≥ 0 holds, as in SciPy's least_squares."""
        t = [0.4 * i for i in range(20)]
        rest = [0.31, -0.52, 0.12, 0.47, -0.73, 0.22, -0.11, 0.68, -0.35, 0.05, -0.44, 0.58, -0.09, -0.61, 0.4, 0.17,
                -0.28, 0.33, -0.5, 0.02]
        deviations = [0.3 + 0.01 * s for s in t]
        data = [80 * math.exp(-s / 1.7) - 0.2 + r for s, r in zip(t, rest)]
        exact = lambda a, k: [a * math.exp(-s / (1e-6 * k)) for s in t]

        def digits(x):
            if hash(tuple(map(float, x))) % 10 == 3 and list(x) != [50, 1e6, 5]:
                raise ValueError("no mesh")
            return [float(f"{y + x[2]:.6g}") for y in exact(x[0], x[1])]

        found = self.fit(digits, data, {"a": 50, "k": 1e6, "c": 5}, sigma=deviations, bounds=(0, [1e3, 1e9, 1e3]))
        free = self.fit(lambda x: exact(*x), data, {"a": 50, "k": 1e6}, sigma=deviations)
        self.assertEqual((found.status, found.x[2]), ("converged", 0))
        for i in range(2):
            self.assertLess(abs(found.x[i] - free.x[i]), 0.02 * free.sd[i])
            self.assertAlmostEqual(found.sd[i] / free.sd[i], 1, delta=0.02)
        self.assertAlmostEqual(found.correlation[0][1], free.correlation[0][1], delta=0.01)

    def test_check_names_the_failed_call_at_the_start(self):
        script = self.folder + "/dead.py"
        with open(script, "w") as file:
            file.write("import isoline\ndef forward(x):\n    raise OSError('no licence')\n"
                       "isoline.problem(forward, start=[3, 1], target=[1, 2, 3])\n")
        ran = subprocess.run([os.environ["ISOLINE"], "check", f"process[command=\"{sys.executable} {script}\"]"],
                             capture_output=True, text=True, timeout=60)
        self.assertEqual(ran.returncode, 2)
        self.assertIn("x = (3, 1) failed: OSError: no licence", ran.stdout)
        self.assertIn("1 check, 1 failed", ran.stdout)

    def test_makes_several_calls_at_once(self):
        running, most = [], []

        def forward(x):
            running.append(1)
            most.append(len(running))
            time.sleep(0.05)
            running.pop()
            return theophylline(x)

        _, data, given, x, sd, *_ = CALIBRATIONS["theophylline"]
        result = self.fit(forward, data, **given, workers=3)
        self.assertLessEqual(max(abs(a - b) / s for a, b, s in zip(result.x, x, sd)), 0.01)
        self.assertGreater(max(most), 1)
        self.assertLessEqual(max(most), 3)

    def test_shows_itself_in_a_notebook(self):
        result = self.fit(misra, MISRA_Y, [500, 1e-4], names=["a<b", "c"], units=["psi", ""])
        profile = result.profile()
        with open(self.folder + "/results/profile.json") as file:
            kept = json.load(file)["cells"][0]
        self.assertEqual(kept["cell"], self.record()["cell"])
        self.assertNear([kept["profiles"][0]["low"], kept["profiles"][0]["high"]], profile.interval[0], 1e-12)
        page = xml.etree.ElementTree.fromstring(f"<div>{result._repr_html_()}</div>")
        self.assertEqual([each.tag for each in page].count("table"), 3)
        self.assertIn("a<b", "".join(page.itertext()))
        self.assertIn("238.94", result.table())

    def test_refuses_arguments_with_their_names(self):
        for word, arguments in (("names", {"names": ["a"]}), ("q", {"fixed": ["q"]}), ("bounds", {"bounds": ([0, 0], [1, 1])}),
                                ("nosuch", {"methods": "nosuch"}), ("newton", {"methods": "newton"}), ("sigma", {"sigma": [1, 2]}),
                                ("log", {"log": ["x2"], "x0": [500, -1]})):
            with self.assertRaisesRegex(isoline.Refused, word):
                self.fit(misra, MISRA_Y, **{"x0": [500, 1e-4], **arguments})
        with self.assertRaisesRegex(isoline.Refused, "14"):
            self.fit(misra, MISRA_Y[1:], [500, 1e-4])

    def test_an_interrupted_fit_goes_on(self):
        script = self.folder + "/slow.py"
        with open(script, "w") as file:
            file.write("import isoline, sys, time\nsys.path.insert(0, sys.argv[1])\ncalls = []\n"
                       "def forward(x):\n    calls.append(1)\n    time.sleep(0.11)\n    print('call', flush=True)\n"
                       f"    return [x[0] * c / (x[1] + c) for c in {PPM}]\n"
                       f"isoline.fit(forward, {CALIBRATIONS['puromycin'][1]}, [100, 1], out='results')\nprint('made', len(calls))\n")
        words = [sys.executable, script, CLIENTS]
        environment = dict(os.environ, PYTHONPATH=CLIENTS, TMPDIR=self.folder)
        with subprocess.Popen(words, cwd=self.folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            for _ in range(15):
                run.stdout.readline()
            run.send_signal(signal.SIGINT)
            _, errors = run.communicate(timeout=60)
        self.assertIn("KeyboardInterrupt", errors)
        self.assertEqual([each for each in os.listdir(self.folder) if each.startswith("isoline-")], [])
        ran = subprocess.run(words, cwd=self.folder, env=environment, capture_output=True, text=True, timeout=120)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        made = int(ran.stdout.split()[-1])
        with open(next(f"{self.folder}/results/runs/{each}" for each in os.listdir(self.folder + "/results/runs"))) as file:
            self.assertLess(made, json.load(file)["summary"]["work"] - 5)


class Tables(unittest.TestCase):
    def setUp(self):
        self.path = self.enterContext(tempfile.TemporaryDirectory()) + "/data.csv"

    def read(self, text, encoding="utf-8", **more):
        with open(self.path, "w", encoding=encoding) as file:
            file.write(text)
        return isoline.read_data(self.path, **more)

    def test_counts_the_comments_above_the_header_as_lines(self):
        self.assertEqual(list(self.read("# of May\n#\nt,y\n1,2\n").y), [2])
        with self.assertRaisesRegex(isoline.Refused, "line 5"):
            self.read("# of May\n#\nt,y\n1,2\n2,\n")

    def test_reads_columns_by_the_names_of_the_header(self):
        data = self.read("t,y,sigma\n1,2,0.1\n3,4e0,0.2\n")
        self.assertEqual((data.x, list(data["t"]), list(data.y), list(data.sigma)), ("t", [1, 3], [2, 4], [0.1, 0.2]))
        data = self.read("t;u;e\n1;2;0.1\n", y="u", sigma="e")
        self.assertEqual((list(data.y), list(data.sigma)), ([2], [0.1]))
        self.assertIsNone(self.read("t,y\n1,2\n").sigma)
        self.assertEqual(list(self.read('"t","y"\n1,2\n').y), [2])  # as R writes it
        self.assertEqual(list(self.read("t,y,\xb5\n1,2,3\n", encoding="latin-1").y), [2])

    def test_refuses_missing_values_by_their_line(self):
        for text, word in (("t,y\n1,2\n2,\n", "line 3, column y"), ("t,y\n1,NA\n", "line 2, column y"), ("t,y\n1,2\n\n3\n", "line 4"),
                           ("t,y\nnan,2\n", "line 2, column t"), ("t,y\n1_0,2\n", "line 2, column t"),
                           (f"t,y\n1,2\n1,{'9' * 200_000}\n", "data.csv, line 3: expected fields"),
                           ("t,z\n1,2\n", "data.csv.*'y'"), ("y,y\n1,2\n", "no name twice")):
            with self.assertRaisesRegex(isoline.Refused, word):
                self.read(text)
        with self.assertRaisesRegex(isoline.Refused, "data"):
            isoline.fit(misra, [1, 2, math.nan], [1, 2])

    @unittest.skipUnless(pandas, "pandas is not installed")
    def test_reads_frames(self):
        frame = pandas.DataFrame({"t": [1, 2], "y": [3.0, 4]})
        self.assertEqual(list(isoline.read_data(frame).y), [3, 4])
        frame.loc[1, "y"] = None
        with self.assertRaisesRegex(isoline.Refused, "row 1, column y"):
            isoline.read_data(frame)

    @unittest.skipUnless(pandas, "pandas is not installed")
    def test_names_records_that_it_cannot_load(self):
        folder = os.path.dirname(self.path)
        os.mkdir(folder + "/runs")
        damaged = {"cell": "c", "build": "b", "request": {"problem": {"spec": "p"}, "optimizer": {"spec": "o"}, "seed": 0},
                   "status": "target", "summary": {"loss": []}}
        for name, text in (("a.json", '{"cell": '), ("b.json", "[]"), ("c.json", json.dumps(damaged))):
            with open(f"{folder}/runs/{name}", "w") as file:
                file.write(text)
        os.mkfifo(folder + "/runs/d.json")
        with self.assertWarnsRegex(UserWarning, "a.json.*") as seen:
            self.assertEqual(len(isoline.load(folder).runs), 0)
        self.assertEqual(len(seen.warnings), 4)

    def test_prints_what_its_page_shows(self):
        with open(os.path.join(CLIENTS, "../../docs/bring-a-simulator.md"), encoding="utf-8") as file:
            page = file.read()
        folder = os.path.dirname(self.path)
        with open(folder + "/fit.py", "w", encoding="utf-8") as file:
            file.write("# fit.py\n" + page.split("```python\n# fit.py\n")[1].split("```")[0])
        with open(folder + "/misra1a.csv", "w") as file:
            file.write("x,y\n" + "".join(f"{x},{y}\n" for x, y in zip(MISRA_X, MISRA_Y)))
        ran = subprocess.run([sys.executable, "fit.py"], cwd=folder, env=dict(os.environ, PYTHONPATH=CLIENTS, PYTHONUTF8="1"),
                             capture_output=True, text=True, encoding="utf-8", timeout=60)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        shown = page.splitlines()
        for line in ran.stdout.splitlines()[1:]:  # the first one has the calls
            self.assertTrue(line in shown, line)

    def test_fits_a_file(self):
        with open(self.path, "w") as file:
            file.write("x,y\n" + "".join(f"{x},{y}\n" for x, y in zip(MISRA_X, MISRA_Y)))
        data = isoline.read_data(self.path)
        result = isoline.fit(lambda b: [b[0] * (1 - math.exp(-b[1] * x)) for x in data["x"]], data, [500, 1e-4],
                             out=os.path.dirname(self.path) + "/results", progress=False)
        self.assertAlmostEqual(result.x[0], 238.94212918, delta=1e-4)
        self.assertIsInstance(result.x, numpy.ndarray)


if __name__ == "__main__":
    unittest.main()
