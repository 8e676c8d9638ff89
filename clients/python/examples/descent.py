"""Gradient descent with a step that grows while the loss falls; needs no package."""
import isoline

p = isoline.optimizer(["pullback"], "descent-python", reports=True)
x, rate = list(p.x0), 1e-3
loss, gradient = p.value_and_grad(x)
while True:  # the first call after the end of the run exits the script
    ahead = [a - rate * b for a, b in zip(x, gradient)]
    there, slope = p.value_and_grad(ahead)
    if there < loss:
        x, loss, gradient, rate = ahead, there, slope, 1.2 * rate
    else:
        rate /= 2
    p.report(x)
