"""CMA-ES of the package cmaes; Hansen (2016). On Debian: apt install python3-cmaes

The first standard deviation is 0.1 max(1, ‖x₀‖∞).
"""
from cmaes import CMA

import isoline

p = isoline.optimizer(name="cmaes")
method = CMA(mean=p.x0, sigma=0.1 * max(1, abs(p.x0).max()), seed=isoline.seed())


def loss(x):
    value = p.value(x)
    return value if value == value else float("inf")


while not method.should_stop():
    points = [method.ask() for _ in range(method.population_size)]
    told = [(x, loss(x)) for x in points]
    method.tell(told)
p.finish(min(told, key=lambda each: each[1])[0])
