"""A chain of 40 nonlinear springs in PyTorch: which displacements balance the observed forces?"""
import torch

import isoline

torch.set_num_threads(1)
n = 40


def forward(u):  # the force on each node, of springs with tension s + s³ between neighbours
    stretch = torch.diff(torch.nn.functional.pad(u, (1, 1)))
    return -torch.diff(stretch + stretch**3)


shape = torch.sin(torch.linspace(0, 3.14159, n + 2, dtype=torch.float64))[1:-1]
isoline.problem(forward, torch.zeros(n), truth=3 * shape, name="spring-torch")
