# Gradient descent that halves its step, by lines of text. Its arithmetic is awk's.
ask() { echo "isoline $*"; read -r answer; }

echo "a line of its own"
ask optimizer name=halving_in_sh needs=pullback reports
set -- $answer
n=$1
shift 2
x=$(echo "$*" | cut -d' ' -f "1-$n")
step=1
ask value $x
loss=$answer
while :; do
  ask gradient $x
  ahead=$(echo "$x $answer" | awk -v n="$n" -v s="$step" '{ for (i = 1; i <= n; i++) printf "%.17g ", $i - s * $(n + i) }')
  ask value $ahead
  if awk -v a="$answer" -v b="$loss" 'BEGIN { exit !(a + 0 < b + 0) }'; then
    x=$ahead loss=$answer
    step=$(awk -v s="$step" 'BEGIN { printf "%.17g", 2 * s }')
    ask report $x
  elif awk -v s="$step" 'BEGIN { exit !(s < 1e-9) }'; then
    break
  else
    step=$(awk -v s="$step" 'BEGIN { printf "%.17g", s / 2 }')
  fi
done
ask claim the step is small
ask finish $x
