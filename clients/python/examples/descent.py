"""Gradient descent without any package, with a step that grows while the loss falls."""
import isoline

p = isoline.optimizer(["pullback"], "descent-python", reports=True)
x, rate = list(p.x0), 1e-3
loss, gradient = p.value_and_grad(x)
while True:  # until the run is over, which leaves the script
    ahead = [a - rate * b for a, b in zip(x, gradient)]
    there, slope = p.value_and_grad(ahead)
    if there < loss:
        x, loss, gradient, rate = ahead, there, slope, 1.2 * rate
    else:
        rate /= 2
    p.report(x)
