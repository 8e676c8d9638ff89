"""My optimizer: v ← β v − η ∇L, θ ← θ + v. Say here which formula this is, where it comes from and
how it deviates from there."""
import isoline

RATE, MOMENTUM = 1e-3, 0.9

p = isoline.optimizer(["pullback"], "my-optimizer", reports=True)
x = list(p.x0)
v = [0.0] * len(x)
while True:  # until the run is over, which leaves the script
    loss, gradient = p.value_and_grad(x)
    v = [MOMENTUM * a - RATE * g for a, g in zip(v, gradient)]
    x = [a + b for a, b in zip(x, v)]
    p.report(x)
