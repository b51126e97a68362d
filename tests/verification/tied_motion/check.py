# SPDX-License-Identifier: MIT
"""Ties in motion: a wave through a tie of unlike meshes, and a tied bar that vibrates, against the spring between bars."""
import functools

import numpy as np

from contact_types import TYPES
from meshes import Deck, grid

YOUNG, RHO, SPEED = 1.0e6, 1000.0, 1.0e-3
SOUND = np.sqrt(YOUNG / RHO)
#: Both halves of the bar, its height, rows of square elements of either half, and the length of the pulse.
HALF, HEIGHT, ROWS, PULSE = 8.0, 0.4, (6, 4), 6.0
#: K L/A of the coarser half, nu = 0.
SPRING = YOUNG / 3.0 * ROWS[1] / HEIGHT


def spring_of(kind):
    """Stiffness of all springs over the height: type 1 has one of the same at each of the 7 nodes, type 3 two passes."""
    return SPRING * {1: (ROWS[0] + 1.0) / ROWS[0], 3: 2.0}.get(kind, 1.0)


def pulse(time):
    """Velocity of the driven end over SPEED."""
    duration = PULSE / SOUND
    return np.where((time > 0.0) & (time < duration), 0.5 - 0.5 * np.cos(2.0 * np.pi * time / duration), 0.0)


def bar(kind, end_time, is_driven):
    """A bar in x of two tied halves, whole where kind is 0: its left end driven, or held with a first velocity like the
    lowest mode of the whole. Returns the deck and the node half way to the tie."""
    deck = Deck(f"tied bar, type {kind}")
    deck.control(end_time, scale=0.8).hourglass(4, 0.05)
    halves, places = [], []
    for part, rows in enumerate(ROWS, 1):
        if kind == 0 and part == 2:
            break
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
        n, length = round(HALF * rows / HEIGHT), HALF
        if kind == 0:
            n, length = 2 * n, 2.0 * HALF
        coordinates, quads = grid(n, rows, length, HEIGHT, (HALF * (part - 1), 0.0))
        halves.append((deck.mesh(coordinates, quads, part=part), n))
        places.append(coordinates[:, 0])
    if kind:
        (left, n), (right, m) = halves
        deck.node_set(1, left[n::n + 1]).node_set(2, right[::m + 1][::-1])
        deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4), (0.0, 1.0e20), (0.0, 1.0, 1))
    ids, n = halves[0]
    if is_driven:
        time = np.linspace(0.0, PULSE / SOUND, 401)
        deck.curve(1, [*zip(time.tolist(), (SPEED * pulse(time)).tolist()), (1.0e3, 0.0)])
        for node in ids[::n + 1]:
            deck.prescribe(node, 1, 0, 1)
    else:
        deck.fix(ids[::n + 1], x=1)
        every = np.concatenate([half[0] for half in halves])
        deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), SPEED * np.sin(np.pi * x / (4.0 * HALF)), 0.0)
                                             for node, x in zip(every, np.concatenate(places))])
    watch = ids[round(0.5 * HALF * ROWS[0] / HEIGHT)]
    every = 0.05 if is_driven else 0.25
    deck.output(glstat=2.0 * every / SOUND, nodout=every / SOUND, nodes=[int(watch)])
    return deck


@functools.cache
def came_back(spring):
    """Times, and velocity over SPEED that comes at a spring k between two half spaces and does not pass: v_r = v_i - v_t
    with v_t + tau dv_t/dt = v_i, tau = rho c/(2 k)."""
    tau = RHO * SOUND / (2.0 * spring)
    fine = np.linspace(0.0, 3.0 * PULSE / SOUND, 60001)
    decay = np.exp(-(fine[1] - fine[0]) / tau)
    came, gone = pulse(fine), np.zeros_like(fine)
    for k in range(1, len(fine)):
        gone[k] = decay * gone[k - 1] + (1.0 - decay) * 0.5 * (came[k] + came[k - 1])
    return fine, came - gone


def reflected(kind, time):
    """Velocity half way to the tie that comes back."""
    return np.interp(time - 1.5 * HALF / SOUND, *came_back(spring_of(kind)), left=0.0)


#: Elements of the coarser half to a wave, at which the reflection is looked at: from 942 on it is below 1 % in amplitude,
#: from 94 on in energy (type 3, with two springs: from half as many).
TO_A_WAVE = np.array([960.0, 471.0, 200.0, 94.2, 60.0, 40.0])


def check_law(run, kind, time, velocity, later):
    """What comes back, frequency by frequency: both records transformed, since each is a whole transient. A spring between
    two half bars reflects r = i w tau/(1 + i w tau) = i w Z/(2 k + i w Z), Z = rho c."""
    w = 2.0 * np.pi * SOUND * ROWS[1] / (HEIGHT * TO_A_WAVE)
    delay = np.where(later, HALF / SOUND, 0.0)
    waves = velocity * np.exp(-1j * w[:, None] * (time - delay))
    found = np.trapezoid(waves[:, later], time[later], axis=1) / np.trapezoid(waves[:, ~later], time[~later], axis=1)
    exact = 1j * w * RHO * SOUND / (2.0 * spring_of(kind))
    exact = exact / (1.0 + exact)
    run.check(f"type {kind}: reflection over that of the spring, {TO_A_WAVE[-1]:.0f} to {TO_A_WAVE[0]:.0f} elements a wave",
              found / exact, np.ones(len(w)))
    title = f"type {kind}: reflection in amplitude, {TO_A_WAVE[0]:.0f} elements a wave"
    run.check(title, abs(found[0]), 0.01)


def check_wave(run):
    """The velocity half way to the tie: first the pulse, later what comes back."""
    for kind in (*TYPES, 0):
        result = run.program(bar(kind, 2.4 * HALF / SOUND, True), name=f"wave_{kind}")
        row = result.table("nodout")
        later = row["time"] > (0.5 * HALF + PULSE + 1.0) / SOUND
        time, found = row["time"][later], row["vx"][later] / SPEED
        if kind == 0:
            run.report("the whole bar: largest velocity behind the pulse", np.max(np.abs(found)), "dispersion")
            continue
        exact = reflected(kind, time)
        run.check(f"type {kind}: wave that comes back, over the pulse", found, exact)
        check_law(run, kind, row["time"], row["vx"] / SPEED, later)
        came = 0.375 * PULSE / SOUND
        run.check(f"type {kind}: energy that comes back over that of the pulse",
                  np.trapezoid(found ** 2, time) / came, 0.01)
        run.check(f"type {kind}: wave, energy ratio", result.table("glstat")["energy_ratio"][1:], 1.0)


def check_bar(run):
    """Longitudinal period of the bar held at one end, from the zero crossings of some 8 periods."""
    periods = {}
    for kind in (0, *TYPES):
        row = run.program(bar(kind, 70.0 * HALF / SOUND, False), name=f"bar_{kind}").table("nodout")
        time, v = row["time"], row["vx"]
        k = np.nonzero(v[:-1] * v[1:] < 0.0)[0]
        cross = time[k] - v[k] * (time[k + 1] - time[k]) / (v[k + 1] - v[k])
        periods[kind] = 2.0 * (cross[-1] - cross[0]) / (len(cross) - 1)
    run.check("whole bar: period c/(8 half)", periods[0] * SOUND / (8.0 * HALF), 1.0)
    for kind in TYPES:
        low, high = 0.5 * np.pi / (4.0 * HALF), np.pi / (4.0 * HALF)
        for _ in range(60):  # tan(2 q half) = 2 k/(E q)
            q = 0.5 * (low + high)
            low, high = (q, high) if np.tan(2.0 * q * HALF) < 2.0 * spring_of(kind) / (YOUNG * q) else (low, q)
        run.check(f"type {kind}: period tied over whole", periods[kind] / periods[0],
                  np.pi / (4.0 * HALF) / q)


#: A cantilever of two layers: its length, its height, and elements over the height.
BEAM, DEPTH, N_DEPTH = 4.0, 0.8, 8


def beam(kind):
    """Held at the left end, whole where kind is 0, else tied along its middle; a first velocity like its lowest mode.
    Returns the deck and a node at the tip."""
    deck = Deck(f"tied beam, type {kind}")
    deck.control(16.0, scale=0.8).hourglass(4, 0.05)
    columns, every = round(BEAM * N_DEPTH / DEPTH), []
    for part in (1, 2) if kind else (1,):
        deck.part(part).elastic(RHO, YOUNG, 0.0, part)
        rows = N_DEPTH // 2 if kind else N_DEPTH
        coordinates, quads = grid(columns, rows, BEAM, DEPTH * rows / N_DEPTH, (0.0, 0.5 * DEPTH * (part - 1)))
        ids = deck.mesh(coordinates, quads, part=part)
        deck.fix(ids[::columns + 1], 1, 1)
        every.append((ids, coordinates[:, 0]))
    if kind:
        deck.node_set(1, every[1][0][:columns + 1]).node_set(2, every[0][0][:-columns - 2:-1])
        deck.add("*CONTACT_2D_SLIDELINE", (-1, -2, kind, 4), (0.0, 1.0e20), (0.0, 1.0, 1))
    deck.add("*INITIAL_VELOCITY_NODE", *[(int(node), 0.0, SPEED * float(bent(x))) for ids, places in every
                                         for node, x in zip(ids, places)])
    tip = every[0][0][columns]
    deck.output(glstat=0.1, nodout=0.01, nodes=[int(tip)])
    return deck


def bent(x, order=0):
    """Lowest mode of a cantilever, 1 at the tip, or a derivative of it."""
    q, s = 1.8751040687 / BEAM, 0.7340955138
    ways = (np.cosh, np.sinh)
    turn = (lambda z: -np.cos(z), np.sin, np.cos, lambda z: -np.sin(z))
    a = ways[order % 2](q * x) + turn[order % 4](q * x)
    b = ways[(order + 1) % 2](q * x) + turn[(order + 3) % 4](q * x)
    return 0.5 * q ** order * (a - s * b)


def check_beam(run):
    """The tie shears: with V = E I w''' its middle carries 1.5 V/H, which adds (1.5 V/H)^2/(2 k) to the energy of
    E I w''^2/2 (Rayleigh, first order)."""
    periods = {}
    for kind in (0, *(kind for kind in TYPES if kind != 1)):
        result = run.program(beam(kind), name=f"beam_{kind}")
        row = result.table("nodout")
        time, u = row["time"], row["uy"]
        k = np.nonzero(u[1:-1] * u[2:] < 0.0)[0] + 1
        cross = time[k] - u[k] * (time[k + 1] - time[k]) / (u[k + 1] - u[k])
        periods[kind] = 2.0 * (cross[-1] - cross[0]) / (len(cross) - 1)
    x = np.linspace(0.0, BEAM, 4001)
    spring = YOUNG / 3.0 * N_DEPTH / DEPTH
    share = np.mean(bent(x, 3) ** 2) / np.mean(bent(x, 2) ** 2) * 2.25 / DEPTH ** 2 * YOUNG * DEPTH ** 3 / 12.0 / spring
    for kind, period in periods.items():
        if kind == 0:
            run.report("whole beam: period over that of Bernoulli's", period * 1.8751040687 ** 2 / BEAM ** 2 * SOUND
                       * DEPTH / np.sqrt(12.0) / (2.0 * np.pi))
            continue
        run.check(f"type {kind}: period of the beam tied over whole, less 1",
                  period / periods[0] - 1.0, 0.5 * share / (2.0 if kind == 3 else 1.0))


def check(run):
    check_wave(run)
    check_bar(run)
    check_beam(run)
