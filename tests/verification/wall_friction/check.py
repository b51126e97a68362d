# SPDX-License-Identifier: MIT
"""Blocks that slide and stick on rigid walls."""
import subprocess

import numpy as np

from meshes import Deck, grid, rotate

RHO, YOUNG, POISSON = 1000.0, 1.0e8, 0.3
GRAVITY, RAMP = 9.81, 0.02
WIDTH, HEIGHT = 1.0, 0.1
MASS = RHO * WIDTH * HEIGHT


def block(friction, angle, speed=0.0, end=0.5, tilt=0.0, ramp=RAMP):
    """A block on a wall turned by `angle`; gravity, turned by `tilt`, comes within `ramp`. On a level wall what vibrates
    upwards is damped: a block that rings creeps where it should stick."""
    deck = Deck("block on a wall")
    deck.control(end)
    deck.part().elastic(RHO, YOUNG, POISSON).hourglass(4, 0.1)
    coordinates, quads = grid(8, 2, WIDTH, HEIGHT)
    nodes = deck.mesh(rotate(coordinates, angle), quads)
    along, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    if speed:
        deck.add("*INITIAL_VELOCITY", (0,), (*(speed * along),))
    deck.curve(1, [(0.0, 0.0), (ramp, 1.0), (1.0e6, 1.0)])
    deck.add("*LOAD_BODY_Y", (1, GRAVITY * np.cos(tilt)))
    if tilt:
        deck.add("*LOAD_BODY_X", (1, -GRAVITY * np.sin(tilt)))
    if not angle:
        deck.add("*DAMPING_GLOBAL", (0, 4000.0, 0.0, 1.0)).add("*CONTROL_BULK_VISCOSITY", (1.5, 0.5))
    deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, 0.0, 0.0, float(normal[0]), float(normal[1]), 0.0, friction))
    deck.output(glstat=1.0e-3, matsum=1.0e-3, nodout=1.0e-3, nodes=nodes[4:5])
    deck.add("*DATABASE_RWFORC", (1.0e-3,))
    return deck, nodes, along


def speeds(result, along):
    table = result.table("matsum")
    return (table["momentum_x"] * along[0] + table["momentum_y"] * along[1]) / MASS


def check_forces(run, name, result, friction):
    """Coulomb's law, and the balances of momentum and energy."""
    force, energies = result.table("rwforc"), result.table("glstat")
    excess = np.abs(force["tangential_force"]) - friction * force["normal_force"]
    run.check(f"{name}: friction above mu times the normal force", excess.max() / force["normal_force"].max(), 0.0,
              1e-12, "max")
    run.check(f"{name}: energy", energies["total"] - energies["external_work"], np.full_like(
        energies["time"], energies["total"][0]), 1e-3 * max(energies["kinetic"].max(), energies["total"][0]), "abs")
    run.check(f"{name}: friction of glstat and of rwforc", energies["friction"], force["friction"], 1e-14, "rel")
    run.true(f"{name}: friction takes energy", np.all(np.diff(force["friction"]) > -1e-9 * force["friction"].max()))


def check_incline_slides(run):
    """mu 0.3 at 30 degrees: a = g (sin - mu cos)."""
    angle, friction, end = np.radians(-30.0), 0.3, 0.5
    deck, _, along = block(friction, angle, end=end)
    result = run.program(deck, name="incline")
    expected = GRAVITY * (np.sin(-angle) - friction * np.cos(angle))
    time, speed = result.table("matsum")["time"], speeds(result, along)
    run.check("incline: acceleration of the number in the books", expected, 2.35629, 1e-5)
    run.check("incline: speed at the end", speed[-1], expected * (time[-1] - 0.5 * RAMP), 2e-3,
              source="g (sin - mu cos) (t - ramp/2)")
    late = time > 2.0 * RAMP
    run.check("incline: acceleration", np.polyfit(time[late], speed[late], 1)[0], expected, 5e-3,
              source="g (sin - mu cos)")
    check_forces(run, "incline", result, friction)


def check_incline_stops(run):
    """mu 0.7 at 30 degrees, v0 = 1: stops and stays."""
    tilt, friction, speed = np.radians(30.0), 0.7, 1.0
    slowing = GRAVITY * (friction * np.cos(tilt) - np.sin(tilt))
    deck, nodes, _ = block(friction, 0.0, speed, 2.0 * speed / slowing, tilt)
    result = run.program(deck, name="stops")
    way = result.node(int(nodes[4]))["ux"]
    run.check("stop: way of the number in the books", 0.5 * speed ** 2 / slowing, 0.47985, 1e-5)
    ramp = 0.5 * speed * RAMP - slowing * RAMP ** 2 / 24.0
    run.check("stop: way", way[-1], 0.5 * speed ** 2 / slowing + ramp, 5e-3, source="v0^2/2a, and the ramp of gravity")
    stays = result.node(int(nodes[4]))["time"] > 1.3 * (speed / slowing + RAMP)
    run.check("stop: it stays", np.ptp(way[stays]), 0.0, 1e-4 * way[-1], "abs")
    check_forces(run, "stop", result, friction)
    return result


def check_sliding_block(run):
    """mu 0.3 on the level: v0^2/(2 mu g), and all energy goes into friction."""
    friction, speed = 0.3, 1.0
    slowing = friction * GRAVITY
    deck, nodes, _ = block(friction, 0.0, speed, end=1.5 * speed / slowing)
    result = run.program(deck, name="level")
    node, force = result.node(int(nodes[4])), result.table("rwforc")
    ramp = 0.5 * speed * RAMP - slowing * RAMP ** 2 / 24.0
    run.check("level: way", node["ux"][-1], 0.5 * speed ** 2 / slowing + ramp, 5e-3, source="v0^2/(2 mu g), and the ramp")
    run.check("level: dissipated", force["friction"][-1], 0.5 * MASS * speed ** 2, 2e-3, source="m v0^2/2")
    momentum = result.table("matsum")
    sliding = (momentum["time"] > RAMP) & (momentum["time"] < 0.8 * speed / slowing)
    run.check("level: friction is mu times the normal force", force["tangential_force"][sliding],
              friction * force["normal_force"][sliding], 1e-12)
    run.check("level: force along the wall is what fx says", force["fx"], -force["tangential_force"], 1e-15, "abs")
    check_forces(run, "level", result, friction)


def check_sticks(run):
    """FRIC 1 at 45 degrees: no node at the wall moves along it."""
    tilt = np.radians(45.0)
    deck, nodes, _ = block(1.0, 0.0, 0.0, 0.3, tilt, 0.1)
    result = run.program(deck, name="sticks")
    run.check("sticks: the foot stays", result.node(int(nodes[4]))["ux"], 0.0, 1e-12, "abs")
    force = result.table("rwforc")
    settled = force["time"] > 0.15
    run.check("sticks: mean force along the wall", np.mean(force["tangential_force"][settled]),
              MASS * GRAVITY * np.sin(tilt), 0.02, source="m g sin")
    run.check("sticks: no energy goes into friction", force["friction"][-1], 0.0, 1e-10, "abs")


def square(friction, angle=0.0, slide=0.5, speed=2.0, steps=40):
    """A stiff square that flies obliquely at a wall and hits it inside a step."""
    deck = Deck("oblique impact")
    dt = 1.0e-6
    deck.control(steps * dt, dt=dt)
    deck.part(points=4).elastic(8000.0, 2.0e11, 0.0)
    gap = 7.3 * speed * dt
    coordinates, quads = grid(1, 1, 1.0, 1.0, (0.0, gap))
    nodes = deck.mesh(rotate(coordinates, angle), quads)
    along, normal = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
    deck.add("*INITIAL_VELOCITY", (0,), (*(slide * along - speed * normal),))
    deck.add("*RIGIDWALL_PLANAR", (0,), (0.0, 0.0, 0.0, float(normal[0]), float(normal[1]), 0.0, friction))
    deck.output(glstat=dt, matsum=dt, nodout=dt, nodes=nodes[:1])
    deck.add("*DATABASE_RWFORC", (dt,))
    return deck, nodes, along


def check_impact(run):
    """The impulse along the wall is mu times the normal one, or what stops the node."""
    for friction, slide in ((0.1, 0.5), (0.4, 0.5), (1.0, 0.5), (0.1, -0.5)):
        name = f"impact with {friction} at {slide}"
        deck, nodes, along = square(friction, slide=slide)
        result = run.program(deck, name=name.replace(" ", "_"))
        node, force = result.node(int(nodes[0])), result.table("rwforc")
        left = slide - np.sign(slide) * min(abs(slide), friction * 2.0) if friction < 1.0 else 0.0
        run.check(f"{name}: speed after it", node["vx"][10], left, 1e-2 * abs(slide), "abs", source="v - mu dv_n, or 0")
        run.check(f"{name}: force in its first step", force["tangential_force"][7], np.sign(slide) * min(
            friction * force["normal_force"][7] if friction < 1.0 else np.inf,
            2000.0 * 2.0 * abs(slide) / 1.0e-6), 1e-9, source="mu F, at most what stops the nodes")


def check_turned(run):
    """The same impact at an oblique wall."""
    found = []
    for angle in (0.0, np.radians(37.0)):
        deck, nodes, along = square(0.1, angle)
        result = run.program(deck, name=f"turned_{len(found)}")
        node = result.node(int(nodes[0]))
        found.append((node["vx"] * along[0] + node["vy"] * along[1], result.table("rwforc")["tangential_force"]))
    run.check("oblique wall: speed along it", found[1][0][:15], found[0][0][:15], 1e-8)
    run.check("oblique wall: friction", found[1][1][:15], found[0][1][:15], 1e-8)


def check_restart(run):
    """A run that goes on while it slides makes the same rows."""
    deck, _, _ = block(0.3, 0.0, 1.0, end=0.1)
    whole = run.program(deck, name="whole")
    deck.add("*DATABASE_BINARY_D3DUMP", (100,))
    dumped = run.program(deck, name="dumped")
    folder = run.work / "goes_on"
    folder.mkdir()
    finished = subprocess.run([str(run.program_path), f"r={dumped.folder / 'dumped.dump01.h5'}", f"d={folder}"],
                              capture_output=True, text=True, timeout=600)
    run.true("the run goes on", finished.returncode == 0)
    for name in ("rwforc", "glstat"):
        run.true(f"{name} is the same to the bit",
                 (folder / f"dumped.{name}.csv").read_bytes() == whole.csv_path(name).read_bytes())


def check(run):
    check_incline_slides(run)
    check_incline_stops(run)
    check_sliding_block(run)
    check_sticks(run)
    check_impact(run)
    check_turned(run)
    check_restart(run)
