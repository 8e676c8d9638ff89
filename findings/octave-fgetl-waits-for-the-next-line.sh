#!/usr/bin/env bash
# Octave 7.3: fgetl(stdin) returns a line only after the first byte of the next one has come.
#
# Guess before the run: a line ends at its newline, as for fgets in C, readLines in R and input() in Python.
# Seen: octave-cli, with standard input a pipe, answers the first of two lines only when the second one is sent. A program
# that waits for the answer before it sends the next line waits without end. Two newlines, or a byte after each line, help.
. "$(dirname "$0")/packages.sh"
debian octave=7.3.0-2 octave-common=7.3.0-2
export OCTAVE_HOME=$root/usr OCTAVE_EXEC_HOME=$root/usr HOME=$work
cat >"$work/run.m" <<'M'
while ischar(line = fgetl(stdin)), printf("%s\n", line); fflush(stdout); end
M
cat >"$work/run.py" <<'P'
import select
import subprocess
import sys

program = subprocess.Popen(sys.argv[1:], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                           stderr=subprocess.DEVNULL)


def answers(seconds):
    return "answers" if select.select([program.stdout], [], [], seconds)[0] else "waits"


program.stdin.write(b"first\n")
program.stdin.flush()
print("after a line:", answers(5))
program.stdin.write(b"s")
program.stdin.flush()
print("after one more byte:", answers(30))
program.stdin.write(b"econd\n")
program.stdin.close()
print(program.stdout.read().split())
P
expect "after a line: waits
after one more byte: answers
[b'first', b'second']" /usr/bin/python3 "$work/run.py" octave-cli -q --norc "$work/run.m"
