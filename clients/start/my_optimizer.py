"""My optimizer: v ← β v − η ∇L, θ ← θ + v. State the formula, its source, and
any deviation from the source."""
import isoline

RATE, MOMENTUM = 1e-3, 0.9

p = isoline.optimizer(["pullback"], "my-optimizer", reports=True)
x = list(p.x0)
v = [0.0] * len(x)
while True:  # the first call after the end of the run exits the script
    loss, gradient = p.value_and_grad(x)
    v = [MOMENTUM * a - RATE * g for a, g in zip(v, gradient)]
    x = [a + b for a, b in zip(x, v)]
    p.report(x)
