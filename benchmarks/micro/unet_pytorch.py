#!/usr/bin/env python3
"""The U-net in PyTorch, which the golden values of tests/networks/unet_test.cpp are from. Prints the
milliseconds of a training step (forward and backward), the median and the best.

  unet_pytorch.py [--levels 4] [--filters 16] [--N 64] [--batch 128] [--padding circular]
                  [--threads 2] [--steps 10]
"""
import argparse
import statistics
import sys
import time

try:
    import torch
except ImportError:
    sys.exit("unet_pytorch.py: this comparison needs PyTorch (Debian: python3-torch), which "
             f"{sys.executable} does not find")
from torch import nn


def double_convolution(channels_in, filters, padding):
    layers = []
    for channels in (channels_in, filters):
        layers += [nn.Conv2d(channels, filters, 3, padding=1, padding_mode=padding),
                   nn.BatchNorm2d(filters), nn.ReLU()]
    return nn.Sequential(*layers)


class Unet(nn.Module):
    def __init__(self, levels=4, filters=16, padding="circular", channels_in=1, channels_out=1):
        super().__init__()
        padding = "zeros" if padding == "zero" else padding
        self.first = double_convolution(channels_in, filters, padding)
        self.down = nn.ModuleList(double_convolution(filters, filters, padding)
                                  for _ in range(levels - 1))
        self.up = nn.ModuleList(double_convolution(2 * filters, filters, padding)
                                for _ in range(levels - 1))
        self.last = nn.Conv2d(filters, channels_out, 1)
        self.finer = nn.Upsample(scale_factor=2, mode="bilinear", align_corners=False)
        self.coarser = nn.MaxPool2d(2)

    def forward(self, x):
        skipped = [self.first(x)]
        for level in self.down:
            skipped.append(level(self.coarser(skipped[-1])))
        x = skipped.pop()
        for level in self.up:
            x = level(torch.cat([skipped.pop(), self.finer(x)], dim=1))
        return self.last(x)


def milliseconds_a_step(network, batch, N, steps):
    x, cotangent = torch.randn(batch, 1, N, N), torch.randn(batch, 1, N, N)
    times = []
    for _ in range(steps + 1):
        network.zero_grad()
        begin = time.perf_counter()
        network(x).backward(cotangent)
        times.append(1e3 * (time.perf_counter() - begin))
    return times[1:]  # the first makes PyTorch ready


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("levels", 4), ("filters", 16), ("N", 64), ("batch", 128),
                          ("threads", 2), ("steps", 10)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--padding", choices=("circular", "zero"), default="circular")
    asked = parser.parse_args()
    torch.set_num_threads(asked.threads)
    network = Unet(asked.levels, asked.filters, asked.padding)
    parameters = sum(p.numel() for p in network.parameters())
    times = milliseconds_a_step(network, asked.batch, asked.N, asked.steps)
    print(f"PyTorch {torch.__version__}, {parameters} parameters, {asked.threads} threads: "
          f"{statistics.median(times):.0f} ms a step (best {min(times):.0f})")


if __name__ == "__main__":
    main()
