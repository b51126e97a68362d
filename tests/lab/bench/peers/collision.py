# SPDX-License-Identifier: MIT
"""The common problem of explicit contact: two blocks that strike each other flat.

Square blocks, L = 1 m, of elastic quads without lateral contraction (nu = 0), n columns above (slave) and 4/5 n below,
come together with the speeds -V/2 and V/2. As two bars would, they are in contact for 2 L/c and part with exchanged
speeds. Springs hold them: pressure over penetration is PENALTY of a node over the length of a slave segment.
All programs take the same constant step. Each run prints one line of JSON: what it is, ns per element and step, and the
mean speeds of the blocks at the end and their momentum, in V/2 and in that of one block.
"""
import json
import math

import numpy as np

LENGTH, RHO, YOUNG, PENALTY, V = 1.0, 1000.0, 1.0e6, 1.0e6, 1.0e-2
C = math.sqrt(YOUNG / RHO)
COURANT, LASTS = 0.3, 2.0  # of a side over the wave speed; of 2 L/c


def step(columns):
    """Time step, s."""
    return COURANT * LENGTH / columns / C


def steps(columns):
    """Steps of a run."""
    return math.ceil(LASTS * 2.0 * LENGTH / C / step(columns))


def below(columns):
    """Columns of the lower block."""
    return columns * 4 // 5


def elements(columns):
    """Of both blocks."""
    return columns ** 2 + below(columns) ** 2


def weights(columns):
    """(n + 1, n + 1): the share of a node in the mass of a block."""
    line = np.full(columns + 1, 1.0 / columns)
    line[[0, -1]] *= 0.5
    return np.outer(line, line)


def report(program, contact, columns, number, seconds, speeds):
    """Print the line; `speeds`: v_y of all nodes of the upper and of the lower block, column by column."""
    upper, lower = (float(np.sum(weights(n) * np.reshape(v, (n + 1, n + 1)))) / (0.5 * V)
                    for n, v in zip((columns, below(columns)), speeds))
    print(json.dumps({"program": program, "contact": contact, "elements": elements(columns), "steps": number,
                      "ns": 1.0e9 * seconds / elements(columns) / number, "upper": upper, "lower": lower,
                      "momentum": upper + lower}), flush=True)
