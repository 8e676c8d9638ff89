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
x0 = begun(5:begun(1) + 4);
if strcmp(name, "leasqr")
  m = begun(2);
  [y, x, success, iterations] = leasqr((1:m)', zeros(m, 1), x0, @(t, x) ask("residual", x));
  printf("done %d none converged_%d%s\n", success, success, sprintf(" %.17g", x));
else
  [x, value, info, output] = fminunc(@both, x0, optimset("GradObj", "on"));
  printf("done %d %d info_%d%s\n", info > 0, output.funcCount, info, sprintf(" %.17g", x));
end
