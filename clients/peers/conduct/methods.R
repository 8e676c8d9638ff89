# Methods of R by its packages' defaults. Values come by lines on standard input; each is one call of the callback.
name <- commandArgs(trailingOnly = TRUE)[1]
input <- file("stdin", "r")
read <- function() as.numeric(strsplit(readLines(input, 1), " ")[[1]])
ask <- function(verb, x) {
  cat(verb, sprintf("%.17g", x), "\n")
  flush(stdout())
  read()
}
value <- function(x) ask("value", x)
slope <- function(x) ask("gradient", x)

begun <- read()
n <- begun[1]; limit <- begun[3]; has_bounds <- begun[4] == 1
part <- function(i) begun[5 + (i * n + 1):((i + 1) * n)]
x0 <- part(0)
lower <- if (has_bounds) part(1) else NULL
upper <- if (has_bounds) part(2) else NULL
open <- function(side, far) if (is.null(side)) rep(far, n) else side

for (run in seq_len(begun[5])) {
  if (name == "nls.lm") {
    control <- minpack.lm::nls.lm.control()
    if (limit > 0) control$maxfev <- limit
    found <- minpack.lm::nls.lm(x0, lower, upper, function(x) ask("residual", x) + 0, control = control)
    end <- list(found$info %in% 1:4, "none", paste0("info_", found$info), found$par)
  } else if (name == "nloptr") {
    options <- list(algorithm = "NLOPT_LD_LBFGS", xtol_rel = 1e-8)
    options$maxeval <- if (limit > 0) limit else 10000
    found <- nloptr::nloptr(x0, value, slope, lower, upper, opts = options)
    end <- list(found$status %in% 1:4, found$iterations, paste0("status_", found$status), found$solution)
  } else if (name == "bobyqa") {
    found <- minqa::bobyqa(x0, value, open(lower, -Inf), open(upper, Inf), if (limit > 0) list(maxfun = limit) else list())
    end <- list(found$ierr == 0, found$feval, paste0("ierr_", found$ierr), found$par)
  } else if (name == "nlminb") {
    found <- nlminb(x0, value, slope, control = if (limit > 0) list(eval.max = limit) else list(),
      lower = open(lower, -Inf), upper = open(upper, Inf))
    end <- list(found$convergence == 0, found$evaluations[[1]], gsub(" ", "_", found$message), found$par)
  } else {
    method <- sub("optim-", "", name)
    found <- if (has_bounds) optim(x0, value, slope, method = method, lower = lower, upper = upper) else
      optim(x0, value, slope, method = method)
    end <- list(found$convergence == 0, found$counts[[1]], paste0("convergence_", found$convergence), found$par)
  }
  ask(paste("done", as.integer(end[[1]]), end[[2]], end[[3]]), end[[4]])
}
