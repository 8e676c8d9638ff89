% leasqr of Octave's package optim, by lines of text: python3 -m lines octave-cli -qf leasqr.m
% On Debian: apt install octave-optim
1;
function numbers = ask(request, x = [])
  printf("isoline %s%s\n", request, sprintf(" %.17g", x));
  fflush(stdout);
  numbers = sscanf(input("", "s"), "%f");  % fgetl waits for the next line, too
end
pkg load optim
begun = ask("optimizer name=octave-leasqr least_squares keeps_bounds failed=1e100");
n = begun(1); m = begun(2);
x0 = begun(3:n + 2); bounds = reshape(begun(n + 3:3 * n + 2), n, 2);
options = struct();
if any(isfinite(bounds(:))), options.bounds = bounds; end
residual = @(t, x) ask("residual", x);
[y, x, converged, iterations] = leasqr((1:m)', zeros(m, 1), x0, residual, 1e-10, 10000, [], [], [], options);
ask(sprintf("claim converged=%d iterations=%d", converged, iterations));
ask("finish", x);
