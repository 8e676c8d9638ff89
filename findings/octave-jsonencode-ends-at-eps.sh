#!/usr/bin/env bash
# Octave 7.3: jsonencode writes a positive number below 2.2e-16 as 0, and a negative one as it is.
#
# Guess before the run: what jsondecode reads is what jsonencode was given, to 15 digits or better, of any size.
# Seen: 2.3e-16 is written with all its digits, and so is -1e-16; 2.2e-16 is 0, as is Planck's constant: the limit is eps. Large
# numbers are whole. Send small ones in other units.
. "$(dirname "$0")/packages.sh"
debian octave=7.3.0-2 octave-common=7.3.0-2
export OCTAVE_HOME=$root/usr OCTAVE_EXEC_HOME=$root/usr HOME=$work
cat >"$work/run.m" <<'M'
for x = [1.2345678901234567e300, pi, 1.2345678901234567e-9, 2.3e-16, 2.2e-16, -1e-16, 6.62607015e-34]
  text = jsonencode(x);
  if str2double(text) == x, text = "the same"; end
  printf("%g: %s\n", x, text);
end
M
expect '1.23457e+300: the same
3.14159: the same
1.23457e-09: the same
2.3e-16: the same
2.2e-16: 0
-1e-16: the same
6.62607e-34: 0' sh -c "octave-cli -q --norc '$work/run.m' 2>/dev/null"
