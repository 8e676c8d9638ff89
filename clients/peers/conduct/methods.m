% Methods of Octave by their defaults. Values come by lines on standard input; each is one call of the callback.
1;
function numbers = ask(verb, x)
  printf("%s%s\n", verb, sprintf(" %.17g", x));
  fflush(stdout);
  numbers = sscanf(input("", "s"), "%f");
end
function [value, slope] = both(x)
  value = ask("value", x);
  if nargout > 1, slope = ask("gradient", x); end
end
warning off
pkg load optim
name = argv(){end};
begun = sscanf(input("", "s"), "%f");
n = begun(1); m = begun(2); limit = begun(3);
x0 = begun(6:n + 5);
bounds = struct();
if begun(4), bounds.bounds = reshape(begun(n + 6:3 * n + 5), n, 2); end
for run = 1:begun(5)
  if strcmp(name, "leasqr")
    [y, x, success, iterations] = leasqr((1:m)', zeros(m, 1), x0, @(t, x) ask("residual", x), [], [], [], [], [], bounds);
    ask(sprintf("done %d none converged_%d", success, success), x);
  else
    options = optimset("GradObj", "on");
    if limit > 0, options = optimset(options, "MaxFunEvals", limit); end
    [x, value, info, output] = fminunc(@both, x0, options);
    ask(sprintf("done %d %d info_%d", info > 0, output.funcCount, info), x);
  end
end
