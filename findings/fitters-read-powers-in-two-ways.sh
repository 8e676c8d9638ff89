#!/usr/bin/env bash
# fityk 1.3.2 and libmatheval 1.1.11 read 2^3^2 as 64, gretl 2022c and muParser 2.3.3 as 512: a model moved is another model.
#
# Guess before the run: all readers of formulas in fitters group powers from the right, as mathematics does: 512.
# Seen: fityk and libmatheval group from the left. -2^2 is -4 in all four, so a check of signs does not show it. Write
# parentheses in a formula that has to move, such as exp(-t^k^2).
. "$(dirname "$0")/packages.sh"
debian fityk=1.3.2-2+b2 gretl=2022c-1 gretl-common=2022c-1 libmatheval-dev=1.1.11+dfsg-5 libmatheval1=1.1.11+dfsg-5 \
  libmuparser-dev=2.3.3-0.1 libmuparser2v5=2.3.3-0.1
cat >"$work/powers.cpp" <<'C'
#include <cstdio>
#include <matheval.h>
#include <muParser.h>
int main() {
  char tower[] = "2^3^2", minus[] = "-2^2";
  mu::Parser p;
  p.SetExpr(tower);
  std::printf("libmatheval %g %g\nmuParser %g", evaluator_evaluate(evaluator_create(tower), 0, nullptr, nullptr),
              evaluator_evaluate(evaluator_create(minus), 0, nullptr, nullptr), p.Eval());
  p.SetExpr(minus);
  std::printf(" %g\n", p.Eval());
}
C
compile "$work/powers.cpp" -lmatheval -lmuparser
printf 'print 2^3^2, -2^2\n' >"$work/p.fit"
printf 'scalar a = 2^3^2\nscalar b = -2^2\nprintf "gretl %%g %%g\\n", a, b\n' >"$work/p.inp"
all() {
  "$work/program"
  cfityk -q "$work/p.fit" </dev/null 2>/dev/null | sed -n 's/^\([-0-9][-0-9 ]*\)$/fityk \1/p'
  HOME=$work GRETL_HOME=$root/usr/share/gretl gretlcli -b "$work/p.inp" 2>/dev/null | grep -E '^gretl -?[0-9]+ '
}
expect 'libmatheval 64 -4
muParser 512 -4
fityk 64 -4
gretl 512 -4' all
