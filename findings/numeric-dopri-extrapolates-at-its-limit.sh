#!/usr/bin/env bash
# npm's numeric 1.2.6: dopri ends at its limit of steps with an empty message, and at() then answers beyond it: 215 for 4.5e-5.
#
# Guess before the run: the message says that the limit was reached. For at(), tried with it, no guess was written down.
# Seen: y' = -y from 1 to t = 10 takes 55 steps. With 5 allowed it ends at t = 0.242, message "", and at(10) is the polynomial
# of the last step, 215; with 50 it is 4.5 times too large. Compare the last of x with the end asked for.
. "$(dirname "$0")/packages.sh"
npm install --silent --prefix "$work" numeric@1.2.6 >/dev/null
cat >"$work/run.mjs" <<'J'
import numeric from 'numeric';
for (const limit of [5, 20, 50, 1000]) {
  const s = numeric.dopri(0, 10, [1], (t, y) => [-y[0]], 1e-8, limit);
  console.log(`limit ${limit}: ${s.iterations} steps to t = ${s.x[s.x.length - 1].toFixed(3)}, ` +
    `message ${JSON.stringify(s.message)}, y(10) = ${s.at(10)[0].toPrecision(3)}`);
}
J
expect 'limit 5: 5 steps to t = 0.242, message "", y(10) = 215
limit 20: 20 steps to t = 1.786, message "", y(10) = 22.1
limit 50: 50 steps to t = 7.815, message "", y(10) = 0.000203
limit 1000: 55 steps to t = 10.000, message "", y(10) = 0.0000454' node "$work/run.mjs"
