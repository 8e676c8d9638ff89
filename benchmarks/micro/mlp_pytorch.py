#!/usr/bin/env python3
# One iteration of Adam on the rotated sine problem (Holl, Koltun, Thuerey, 2022: xi = 32, phi = 45
# degrees, perceptron 2-32-64-32-2, batch 100, float) in PyTorch on one thread: what Isoline's
# iteration is compared with. Prints quartiles in microseconds.
import math
import os
import statistics
import sys
import time

os.environ["OMP_NUM_THREADS"] = "1"  # read when PyTorch is loaded
try:
    import torch
except ModuleNotFoundError:
    sys.exit("mlp_pytorch: PyTorch is not installed; on Debian it is the package python3-torch")

XI, PHI, GAMMA, BATCH = 32.0, math.radians(45), 10.0, 100
WARM, ROUNDS, STEPS = 200, 60, 50  # iterations before timing, rounds, iterations a round

torch.set_num_threads(1)
torch.manual_seed(0)
network = torch.nn.Sequential(
    torch.nn.Linear(2, 32), torch.nn.ReLU(), torch.nn.Linear(32, 64), torch.nn.ReLU(),
    torch.nn.Linear(64, 32), torch.nn.ReLU(), torch.nn.Linear(32, 2))
adam = torch.optim.Adam(network.parameters(), lr=1e-3)


def physics(x):
    z1 = math.cos(PHI) * x[:, 0] - math.sin(PHI) * x[:, 1]
    z2 = math.sin(PHI) * x[:, 0] + math.cos(PHI) * x[:, 1]
    return torch.stack((torch.sin(GAMMA / XI * z1), GAMMA * XI * z2), dim=1)


def step():
    target = 2 * torch.rand(BATCH, 2) - 1
    adam.zero_grad()
    loss = 0.5 * (physics(network(target)) - target).square().sum(1).mean()
    loss.backward()
    adam.step()


for _ in range(WARM):
    step()
times = []
for _ in range(ROUNDS):
    begin = time.perf_counter()
    for _ in range(STEPS):
        step()
    times.append(1e6 * (time.perf_counter() - begin) / STEPS)
low, middle, high = statistics.quantiles(times, n=4)
print(f"PyTorch {torch.__version__}, {torch.get_num_threads()} thread: "
      f"{middle:.0f} us an iteration (quartiles {low:.0f} and {high:.0f})")
