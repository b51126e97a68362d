# SPDX-License-Identifier: MIT
"""A thin ring set flying outwards: hoop stress alone brakes it, a differential equation of one radius."""
import numpy as np

from meshes import Deck, grid

RHO, YOUNG, POISSON = 8930.0, 124.0e9, 0.34
A, B, N, C, M, RATE = 90.0e6, 292.0e6, 0.31, 0.025, 1.09, 1.0
TM, TR, CP = 1356.0, 293.0, 383.0
RADIUS, WIDTH, SPEED, END = 16.0e-3, 0.25e-3, 100.0, 70.0e-6


def ring(law, points):
    deck = Deck("expanding ring").control(END, scale=0.8)
    deck.add("*PART", "ring", (1, 1, 1)).add("*SECTION_SHELL", (1, 15, None, points), (1.0,))
    if law == "015":
        deck.add("*MAT_JOHNSON_COOK", (1, RHO, YOUNG / (2.0 * (1.0 + POISSON)), YOUNG, POISSON),
                 (A, B, N, C, M, TM, TR, RATE), (CP,), (0.0,))
    else:
        deck.add("*MAT_SIMPLIFIED_JOHNSON_COOK", (1, RHO, YOUNG, POISSON), (A, B, N, C, 0.0, 0.0, 0.0, RATE))
    nodes = deck.mesh(*grid(2, 2, WIDTH, WIDTH, (RADIUS - 0.5 * WIDTH, 0.0)))
    deck.node_set(1, nodes).add("*INITIAL_VELOCITY", (1,), (SPEED, 0.0)).fix(nodes[:3], y=1)
    return deck.output(plot=END / 70, glstat=END / 70, nodout=END / 70, nodes=[int(nodes[1])])


class Thread:
    """r'' = -sigma J/(rho r), ln(r/R) = sigma/E + p, J = exp((1 - 2 nu) sigma/E), sigma the flow stress of p, of the rate v/r and of
    the temperature, which rises by J sigma dp/(rho cp); central differences of much smaller steps."""

    def __init__(self, law, n_step=7000):
        self.hot = law == "015"
        dt, r, v, p, sigma, rise = END / n_step, RADIUS, SPEED, 0.0, 0.0, 0.0
        rows = []
        for k in range(n_step + 1):
            if k % (n_step // 70) == 0:
                rows.append((r, v, p, rise, sigma))
            half = v - 0.5 * dt * sigma * np.exp((1.0 - 2.0 * POISSON) * sigma / YOUNG) / (RHO * r)
            r += dt * half
            strain, rate = np.log(r / RADIUS), abs(half / r)
            factor = (1.0 + C * np.log(max(1.0, rate / RATE))) * (1.0 - (rise / (TM - TR)) ** M if self.hot else 1.0)
            sigma = YOUNG * (strain - p)
            if sigma > factor * (A + B * p ** N):
                start, low, high = p, p, p + sigma / YOUNG
                while high - low > 1e-13:
                    p = 0.5 * (low + high)
                    low, high = (p, high) if YOUNG * (strain - p) > factor * (A + B * p ** N) else (low, p)
                sigma = YOUNG * (strain - p)
                rise += np.exp((1.0 - 2.0 * POISSON) * sigma / YOUNG) * sigma * (p - start) / (RHO * CP) * self.hot
            v = half - 0.5 * dt * sigma * np.exp((1.0 - 2.0 * POISSON) * sigma / YOUNG) / (RHO * r)
        self.r, self.v, self.p, self.rise, self.sigma = np.array(rows).T
        self.stop = END / 70 * np.argmax(self.v <= 0.0)


def check(run):
    for law in ("015", "098"):
        exact = Thread(law)
        stopped = int(np.argmax(exact.v <= 0.0))
        run.true(f"{law}: the ring stops on the way", 20 < stopped < 70)
        for name, points in (("one point", None), ("2x2 points", 4)):
            job = f"{law}, {name}"
            result = run.program(ring(law, points), name=job.replace(", ", "_").replace(" ", "_"))
            middle, table = result.table("nodout"), result.table("glstat")
            exact_r, exact_v = (np.interp(middle["time"], np.linspace(0.0, END, 71), one) for one in (exact.r, exact.v))
            flies = middle["time"] < exact.stop
            run.check(f"{job}: growth of the radius until it stops", middle["x"][flies] - RADIUS,
                      exact_r[flies] - RADIUS)
            run.check(f"{job}: largest growth of the radius", middle["x"].max() - RADIUS, exact.r.max() - RADIUS)
            # The rate falls through all decades in the last step before: the strain there is as fine as the step.
            run.check(f"{job}: radius while it swings", middle["x"][~flies], exact_r[~flies])
            run.check(f"{job}: plastic strain", result.cells("plastic_strain")[-1].mean(), exact.p[-1])
            stress = result.cells("stress")[:, :, 2].mean(axis=1)
            # Once the flow is as slow as the waves through the ring its elements go apart, whichever way round-off has them.
            run.check(f"{job}: hoop stress while it flows", stress[3:stopped - 4], exact.sigma[3:stopped - 4])
            start = 0.5 * RHO * RADIUS * WIDTH ** 2 * SPEED ** 2
            run.check(f"{job}: kinetic energy at the start", table["kinetic"][0], start)
            run.check(f"{job}: kinetic energy", table["kinetic"] / start, (exact_v / SPEED) ** 2)
            run.check(f"{job}: energy ratio", table["energy_ratio"], np.ones_like(table["time"]))
            if law == "015":
                run.check(f"{job}: rise of the temperature", result.cells("temperature")[-1].mean() - TR, exact.rise[-1])
