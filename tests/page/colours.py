"""Distances between colours as seen with colour-vision deficiencies.

Simulated at full severity after Machado, Oliveira and Fernandes (2009), table 1; distances are
Euclidean in CIE Lab (D65).
"""

import itertools
import math

VISIONS = {
    "normal": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protanopia": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216),
                   (-0.003882, -0.048116, 1.051998)),
    "deuteranopia": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413),
                     (-0.011820, 0.042940, 0.968881)),
    "tritanopia": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602),
                   (0.004733, 0.691367, 0.303900)),
}
XYZ = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
WHITE = (0.95047, 1, 1.08883)


def times(matrix, vector):
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def linear(share):
    return share / 12.92 if share <= 0.04045 else ((share + 0.055) / 1.055) ** 2.4


def lab(colour, vision):
    rgb = [linear(int(colour[i:i + 2], 16) / 255) for i in (1, 3, 5)]
    seen = [min(1, max(0, value)) for value in times(VISIONS[vision], rgb)]
    x, y, z = (value / white for value, white in zip(times(XYZ, seen), WHITE))
    fx, fy, fz = (t ** (1 / 3) if t > 0.008856 else 7.787 * t + 16 / 116 for t in (x, y, z))
    return 116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)


def least_distance(colours, vision):
    return min(math.dist(lab(a, vision), lab(b, vision))
               for a, b in itertools.combinations(colours, 2))
