"""torch.optim.LBFGS with its strong-Wolfe line search."""
import torch

import isoline

torch.set_num_threads(1)
p = isoline.optimizer(["pullback"], "torch-lbfgs", reports=True, source="torch.optim.LBFGS")
x = torch.tensor(p.x0, dtype=torch.float64, requires_grad=True)
method = torch.optim.LBFGS([x], max_iter=1, line_search_fn="strong_wolfe")


def closure():
    loss, gradient = p.value_and_grad(x)
    x.grad = torch.as_tensor(gradient)
    return torch.tensor(loss, dtype=torch.float64)


while True:  # the first call after the end of the run exits the script
    method.step(closure)
    p.report(x)
