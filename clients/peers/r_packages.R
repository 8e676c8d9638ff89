# A method of an R package, by lines of text: python3 -m lines Rscript r_packages.R nls.lm, nloptr or bobyqa
# They are in minpack.lm, nloptr and minqa, on Debian: apt install r-cran-minpack.lm r-cran-nloptr r-cran-minqa
method <- commandArgs(trailingOnly = TRUE)[1]
input <- file("stdin", "r")

ask <- function(request, x = NULL) {
  cat("isoline", request, sprintf("%.17g", x), "\n")
  flush(stdout())
  as.numeric(strsplit(readLines(input, 1), " ")[[1]])
}

needs <- c(nls.lm = "least_squares needs=jacobian", nloptr = "needs=pullback", bobyqa = "")[method]
begun <- ask(paste0("optimizer name=r-", method, " keeps_bounds failed=1e100 ", needs))
n <- begun[1]
part <- function(i) begun[2 + (i * n + 1):((i + 1) * n)]
x0 <- part(0); lower <- part(1); upper <- part(2)
value <- function(x) ask("value", x)

if (method == "nls.lm") {
  found <- minpack.lm::nls.lm(x0, lower, upper, function(x) ask("residual", x) + 0,
    function(x) matrix(ask("jacobian", x), ncol = n, byrow = TRUE),
    minpack.lm::nls.lm.control(maxiter = 1024, maxfev = .Machine$integer.max))
  x <- found$par; words <- paste("info", found$info, found$message)
} else if (method == "nloptr") {
  found <- nloptr::nloptr(x0, value, function(x) ask("gradient", x), lower, upper,
    opts = list(algorithm = "NLOPT_LD_LBFGS", xtol_rel = 1e-8, maxeval = -1))
  x <- found$solution; words <- found$message
} else {
  radius <- if (any(x0 != 0)) min(0.95, 0.2 * max(abs(x0))) else 0.95  # its own is 0 at 0, which it refuses
  control <- list(npt = n + 2, rhobeg = radius, rhoend = 1e-6 * radius, maxfun = .Machine$integer.max)
  found <- minqa::bobyqa(x0, value, lower, upper, control)
  x <- found$par; words <- found$msg
}
ask(paste("claim", words))
ask("finish", x)
