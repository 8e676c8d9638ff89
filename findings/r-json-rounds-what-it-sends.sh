#!/usr/bin/env bash
# R packages jsonlite 1.8.4 and rjson 0.2.21: toJSON writes 4 decimals, or 15 digits at most, so unknowns change on their way.
#
# Guess before the run: a double comes back from JSON to 15 digits or better, and with digits = NA, "max precision", bit for bit.
# Seen: jsonlite's default is 4 decimals: a rate of 1.23e-5 is sent as 0, and pi as 3.1416. With digits = NA or I(17), and in
# rjson, 15 significant digits are written, so two points of a difference quotient lose the last of theirs. Infinity and NaN
# become texts, "Inf" and "NaN", in both. Write numbers by sprintf("%.17g").
. "$(dirname "$0")/packages.sh"
debian r-base-core=4.2.2.20221110-2 r-cran-jsonlite=1.8.4+dfsg-1 r-cran-rjson=0.2.21-1
export R_HOME=$root/usr/lib/R R_SHARE_DIR=$root/usr/share/R/share R_LIBS=$root/usr/lib/R/site-library:/usr/lib/R/site-library
cat >"$work/run.R" <<'R'
x <- c(1.23e-5, pi, 0.1 + 0.2)
say <- function(name, text) cat(name, text, "-", sum(jsonlite::fromJSON(text) != x), "of 3 changed\n")
say("jsonlite:", jsonlite::toJSON(x))
say("digits = NA:", jsonlite::toJSON(x, digits = NA))
say("digits = I(17):", jsonlite::toJSON(x, digits = I(17)))
say("rjson:", rjson::toJSON(x))
cat("Inf, NaN:", jsonlite::toJSON(c(Inf, NaN)), rjson::toJSON(c(Inf, NaN)), "\n")
R
expect 'jsonlite: [0,3.1416,0.3] - 3 of 3 changed
digits = NA: [1.23e-05,3.14159265358979,0.3] - 2 of 3 changed
digits = I(17): [1.23e-05,3.14159265358979,0.3] - 2 of 3 changed
rjson: [1.23e-05,3.14159265358979,0.3] - 2 of 3 changed
Inf, NaN: ["Inf","NaN"] ["Inf","NaN"] ' "$R_HOME/bin/exec/R" --vanilla --slave -f "$work/run.R"
