#!/usr/bin/env bash
# npm's ml-levenberg-marquardt 5.1.0: its differences have an absolute step of 0.1, so its fit is another point.
#
# Guess before the run: the step is relative, near 1e-8, and the fit agrees with MINPACK's to six digits.
# Seen: a exp(-b t) + c ends after all 1,000 iterations at b = 0.71722, where the least sum of squares is at 0.71812, and no
# further iteration changes it; with gradientDifference = 1e-6 it is right. With b in units of 1e-6 the sum of squares is
# eight times the least one, with b in units of 1e3 all unknowns stay at their start. Give a step for each unknown.
. "$(dirname "$0")/packages.sh"
npm install --silent --prefix "$work" ml-levenberg-marquardt@5.1.0 >/dev/null
cat >"$work/run.mjs" <<'J'
import { levenbergMarquardt } from 'ml-levenberg-marquardt';
const x = Array.from({ length: 21 }, (_, i) => 0.25 * i);
const y = x.map((t, i) => 2.5 * Math.exp(-0.7 * t) + 0.5 + 0.05 * Math.sin(7 * i));
function fit(name, unit, more) {
  const model = ([a, b, c]) => (t) => a * Math.exp(-b * unit * t) + c;
  const r = levenbergMarquardt({ x, y }, model,
    { initialValues: [1, 1 / unit, 0], maxIterations: 1000, errorTolerance: 1e-12, ...more });
  console.log(`${name}: b = ${(r.parameterValues[1] * unit).toFixed(5)}, sum of squares ${r.parameterError.toFixed(6)}, ` +
    `${r.iterations} iterations`);
}
fit('default', 1, {});
fit('step 1e-6', 1, { gradientDifference: 1e-6 });
fit('units of 1e-6', 1e-6, {});
fit('units of 1e3', 1e3, {});
J
expect 'default: b = 0.71722, sum of squares 0.024374, 1000 iterations
step 1e-6: b = 0.71812, sum of squares 0.024372, 1000 iterations
units of 1e-6: b = 0.99433, sum of squares 0.197634, 1000 iterations
units of 1e3: b = 1.00000, sum of squares 25.512435, 3 iterations' node "$work/run.mjs"
