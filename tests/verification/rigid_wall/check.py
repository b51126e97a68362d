# SPDX-License-Identifier: MIT
"""Bars and blocks against rigid walls."""

import numpy as np

from meshes import Deck, grid, lumped_mass, rotate

RHO, YOUNG, SPEED = 8000.0, 2.0e11, 2.0
LENGTH, HEIGHT, N = 1.0, 0.02, 200
WAVE = np.sqrt(YOUNG / RHO)
MASS = RHO * LENGTH * HEIGHT
CONTACT = 2.0 * LENGTH / WAVE


def wall(deck, tail, normal, nodes=0, without=0, times=(0.0, 0.0), title=None):
    head = np.asarray(tail) + np.asarray(normal)
    deck.add("*RIGIDWALL_PLANAR" + ("_ID" if title else ""), *([title] if title else []),
             (nodes, without, 0, 0.0, *times),
             (float(tail[0]), float(tail[1]), 0.0, float(head[0]), float(head[1]), 0.0))
    return deck


def bar(angle=0.0, shift=(0.0, 0.0), end=1.5 * CONTACT, n=N):
    """An elastic bar of nu = 0 that flies along -x (turned by `angle`) at a wall; sides free."""
    deck = Deck("bar and wall")
    dt = 0.5 * LENGTH / n / WAVE
    deck.control(end, dt=dt)
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    coordinates, quads = grid(n, 1, LENGTH, HEIGHT)
    coordinates = rotate(coordinates, angle) + np.asarray(shift)
    nodes = deck.mesh(coordinates, quads)
    normal = np.array([np.cos(angle), np.sin(angle)])
    deck.add("*INITIAL_VELOCITY", (0,), (*(-SPEED * normal),))
    deck.node_set(1, nodes[::n + 1])
    wall(deck, np.asarray(shift), 2.0 * normal, title="         7the wall")
    deck.output(plot=end / 20.0, glstat=dt, matsum=dt)
    deck.add("*DATABASE_RWFORC", (dt,))
    return deck, dt, normal


def check_bar(run, name, angle, shift):
    """Contact for 2L/c, pressure rho c v, then the bar flies back as it came."""
    deck, _, normal = bar(angle, shift)
    result = run.program(deck, name=name.replace(" ", "_"))
    force = result.table("rwforc")
    run.true(f"{name}: number of the wall", np.all(force["wall"] == 7))
    plateau = (force["time"] > 0.1 * CONTACT) & (force["time"] < 0.9 * CONTACT)
    expected = RHO * WAVE * SPEED * HEIGHT
    run.check(f"{name}: mean force on the plateau", np.mean(force["normal_force"][plateau]),
              expected)
    run.check(f"{name}: impulse", force["impulse"][-1], 2.0 * MASS * SPEED)
    half = force["impulse"][np.searchsorted(force["time"], 0.5 * CONTACT)]
    run.check(f"{name}: impulse at half of the contact", half, MASS * SPEED)
    run.check(f"{name}: time of contact",
              2.0 * MASS * SPEED / np.mean(force["normal_force"][plateau]), CONTACT)
    late = force["time"] > 1.1 * CONTACT
    run.check(f"{name}: force after the rebound", np.mean(force["normal_force"][late]) / expected,
              0.0)
    run.check(f"{name}: direction of the force", np.stack([force["fx"], force["fy"]], -1),
              force["normal_force"][:, None] * normal)
    momentum = result.table("matsum")
    rebound = (momentum["momentum_x"][-1] * normal[0] + momentum["momentum_y"][-1] * normal[1]) / MASS
    run.check(f"{name}: velocity of the rebound", rebound, SPEED)
    balance = (momentum["momentum_x"] * normal[0] + momentum["momentum_y"] * normal[1]) + MASS * SPEED
    run.check(f"{name}: change of momentum is the impulse", balance[-1], force["impulse"][-1])
    energies = result.table("glstat")
    run.check(f"{name}: energy ratio", energies["energy_ratio"], np.ones_like(energies["time"]))
    run.check(f"{name}: energy lost in the wall is the external work",
              energies["external_work"][-1], force["work"][-1])
    # The nodes on the wall stop at once: half an element of the bar loses its energy, once.
    lost = 0.5 * (RHO * HEIGHT * 0.5 * LENGTH / N) * SPEED ** 2
    run.check(f"{name}: energy lost in the wall", -force["work"][-1], lost)
    return 1.0 - rebound / SPEED


def check_order(run, last):
    """What ringing keeps of the rebound falls as the front gets sharper."""
    missing = []
    for n in (50, 100):
        deck, _, normal = bar(n=n)
        momentum = run.program(deck, name=f"bar_{n}").table("matsum")
        missing.append(1.0 - momentum["momentum_x"][-1] * normal[0] / MASS / SPEED)
    missing.append(last)
    for k in (1, 2):
        run.check(f"order of the rebound velocity, {25 * 2 ** k} to {50 * 2 ** k} elements",
                  np.log2(missing[k - 1] / missing[k]), 2.0 / 3.0)


def check_touching(run):
    """A square flies through a gap that ends inside a step: it stops exactly at the wall."""
    deck = Deck("rigid stop")
    dt = 1.0e-6
    deck.control(40 * dt, dt=dt)
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    gap = 7.3 * SPEED * dt
    coordinates, quads = grid(1, 1, 1.0, 1.0, (0.0, gap))
    nodes = deck.mesh(coordinates, quads)
    deck.add("*INITIAL_VELOCITY", (0,), (0.5, -SPEED))
    wall(deck, (0.0, 0.0), (0.0, 1.0))
    deck.output(glstat=dt, matsum=dt, nodout=dt, nodes=nodes[:1])
    deck.add("*DATABASE_RWFORC", (dt,))
    result = run.program(deck, name="touching")
    node, force = result.node(int(nodes[0])), result.table("rwforc")
    flight = gap - SPEED * node["time"]
    run.check("flight to the wall", node["y"][:8], flight[:8])
    run.check("nodes end on the wall", node["y"][8:11], np.zeros(3))
    run.check("nothing passes the wall", node["y"].min(), 0.0)
    run.check("free along the wall", node["vx"], np.full_like(node["vx"], 0.5))
    mass = lumped_mass(coordinates, quads, RHO)[:2].sum()
    run.check("force of the impact", force["normal_force"][7], 0.7 * mass * SPEED / dt)
    momentum = result.table("matsum")
    run.check("change of momentum is the impulse, at all times",
              momentum["momentum_y"] + RHO * SPEED, force["impulse"])


def check_corner(run):
    """Two walls at 60 degrees: a stiff square in the corner is held by both."""
    deck = Deck("corner")
    dt = 1.0e-6
    deck.control(200 * dt, dt=dt)
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    coordinates, quads = grid(1, 1, 1.0, 1.0)
    coordinates = rotate(coordinates, np.pi / 4.0)
    nodes = deck.mesh(coordinates, quads)
    deck.node_set(1, nodes[:1])
    deck.node_set(2, nodes[1:])
    deck.add("*INITIAL_VELOCITY", (0,), (0.3, -SPEED))
    normals = [np.array([np.sin(a), np.cos(a)]) for a in (np.pi / 3.0, -np.pi / 3.0)]
    wall(deck, (0.0, 0.0), normals[0], 1)
    wall(deck, (0.0, 0.0), normals[1], 0, 2)
    deck.output(glstat=dt, nodout=dt, nodes=nodes[:1])
    deck.add("*DATABASE_RWFORC", (dt,))
    result = run.program(deck, name="corner")
    node, force = result.node(int(nodes[0])), result.table("rwforc")
    early = force["time"] < 50 * dt
    run.true("both walls push", all(np.all(force["normal_force"][early & (force["wall"] == k)]
                                           > 0.0) for k in (1, 2)))
    for k in (0, 1):
        run.check(f"wall {k + 1} is not passed",
                  np.min(node["x"] * normals[k][0] + node["y"] * normals[k][1]), 0.0)
    first = node["time"] < 50 * dt
    run.check("the corner node rests", np.hypot(node["x"], node["y"])[first], np.zeros(first.sum()))


def check_times(run):
    """A wall that is there for a time: free flight before, a stop, free flight after."""
    deck = Deck("birth and death")
    dt = 1.0e-6
    deck.control(30 * dt, dt=dt)
    deck.part(points=4).elastic(RHO, YOUNG, 0.0)
    nodes = deck.mesh(*grid(1, 1))
    deck.add("*INITIAL_VELOCITY", (0,), (0.0, -SPEED))
    wall(deck, (0.0, 0.5), (0.0, 3.0), times=(10.5 * dt, 20.5 * dt))
    deck.output(glstat=dt, nodout=dt, nodes=nodes)
    deck.add("*DATABASE_RWFORC", (dt,))
    result = run.program(deck, name="times")
    force = result.table("rwforc")
    there = (force["time"] > 10.5 * dt) & (force["time"] < 20.5 * dt)
    run.true("force while the wall is there", np.all(force["normal_force"][there] > 0.0))
    run.true("no force before and after", np.all(force["normal_force"][~there] == 0.0))
    node = result.node(int(nodes[0]))
    behind = (node["time"] > 11.5 * dt) & (node["time"] < 20.5 * dt)
    run.check("a node behind the wall goes no further", np.ptp(node["y"][behind]), 0.0)
    run.true("warned of nodes behind the wall",
             "start behind the wall" in result.stderr + (result.folder / "times.log").read_text())


def check_restart(run):
    """A run that goes on in the middle of the contact makes the same rows."""
    deck, dt, _ = bar(end=0.8 * CONTACT, n=50)
    cycles = int(round(0.3 * CONTACT / dt))
    whole = run.program(deck, name="whole")
    run.goes_on(deck, cycles, whole, "rwforc", "glstat")


def check_moving(run):
    """A wall of mass M runs at V into a bar at rest: V falls as exp(-rho c H t/M) until the wave is back."""
    mass, end = 0.6 * MASS, 0.9 * CONTACT
    deck, dt, _ = bar(angle=0.4, end=end)
    text = deck.text().replace("*RIGIDWALL_PLANAR_ID", "*RIGIDWALL_PLANAR_MOVING_ID")
    blocks = text.split("*")
    blocks = [block for block in blocks if not block.startswith("INITIAL_VELOCITY")]
    k = next(k for k, block in enumerate(blocks) if block.startswith("RIGIDWALL"))
    blocks[k] = blocks[k].rstrip("\n") + f"\n{mass!r},{SPEED!r}\n"
    text = "*".join(blocks)
    result = run.program(text, name="moving")
    force, momentum = result.table("rwforc"), result.table("matsum")
    expected = mass * SPEED * (1.0 - np.exp(-RHO * WAVE * HEIGHT * end / mass))
    run.check("impulse of a moving wall", force["impulse"][-1], expected)
    run.check("displacement of a moving wall", force["displacement"][-1], expected / (RHO * WAVE * HEIGHT))
    along = momentum["momentum_x"] * np.cos(0.4) + momentum["momentum_y"] * np.sin(0.4)
    run.check("momentum goes from the wall to the bar", along[-1], force["impulse"][-1])
    run.check("energy ratio with a moving wall", result.table("glstat")["energy_ratio"][1:], np.ones(len(along) - 1))
    run.goes_on(text, int(0.4 * end / dt), result, "rwforc")


def check(run):
    check_moving(run)
    check_order(run, check_bar(run, "bar", 0.0, (0.0, 0.0)))
    check_bar(run, "bar at an oblique wall", np.radians(37.0), (0.3, -0.2))
    check_touching(run)
    check_corner(run)
    check_times(run)
    check_restart(run)
