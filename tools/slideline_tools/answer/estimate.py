# SPDX-License-Identifier: MIT
"""The value that runs on several meshes tend to, and its uncertainty: least squares of f = f0 + c h^p with weights 1/h
(Eca & Hoekstra, J. Comput. Phys. 262, 2014), in the words of ASME V&V 20."""
import dataclasses

import numpy as np

ORDERS = (0.5, 2.0)        # of the fit
SAFETY = 1.25              # on what the finest mesh differs from the limit
UNSURE = 3.0               # the same at a bound of the order, and on the difference of two meshes
SURE = 0.75                # least order by which meshes are predicted
AT_BOUND = 1e-6            # distance of an order from a bound that counts as none
LAST = 3                   # meshes that must go one way


@dataclasses.dataclass(frozen=True)
class Estimate:
    """`value` +- `uncertainty`; `order` of the fit and its `change` c, None where the values go to and fro; `scatter`
    about the fit, or half their range."""

    value: float
    uncertainty: float
    order: float | None = None
    change: float | None = None
    scatter: float = 0.0

    @property
    def relative(self) -> float:
        """Uncertainty over value."""
        return abs(self.uncertainty / self.value) if self.value else np.inf if self.uncertainty else 0.0

    @property
    def is_sure(self) -> bool:
        """Whether a finer mesh can be predicted: a low order or a bound says that the meshes are too coarse for that."""
        return self.order is not None and SURE < self.order < ORDERS[1] - AT_BOUND

    def needed(self, share: float, finest: float) -> float | None:
        """The factor on the mesh that would make `relative` at most `share`; None where no mesh would."""
        target = share * abs(self.value)
        if self.order is None:  # as if the range fell with the size of the elements
            return finest * self.uncertainty / target if target > 0.0 else None
        left = target - 2.0 * self.scatter
        return (safety(self.order) * abs(self.change) / left) ** (1.0 / self.order) if left > 0.0 else None


def estimate(factors, values) -> Estimate:
    """The estimate from the values on meshes divided by `factors`, ascending."""
    h, f = 1.0 / np.asarray(factors, dtype=float), np.asarray(values, dtype=float)
    steps = np.diff(f[-LAST:])
    if len(f) == 1:
        return Estimate(f[0], np.inf)
    if len(f) < LAST:
        return Estimate(f[-1], UNSURE * abs(float(steps[0])))
    if not (np.all(steps > 0.0) or np.all(steps < 0.0)):
        spread = float(np.ptp(f[-LAST:]))
        return Estimate(float(f[-1]), spread, scatter=0.5 * spread)
    order, (limit, change), scatter = fit(h, f)
    return Estimate(limit, safety(order) * float(abs(f[-1] - limit)) + 2.0 * scatter, order, change, scatter)


def safety(order: float) -> float:
    """The factor on what the finest mesh differs from the limit: an order at a bound is not that of the values, which settle faster or
    slower (Eca & Hoekstra's too is 3 outside of their bounds)."""
    return SAFETY if is_between(order) else UNSURE


def is_between(order: float) -> bool:
    """Whether an order is at none of its bounds."""
    return ORDERS[0] + AT_BOUND < order < ORDERS[1] - AT_BOUND


def fit(h, f):
    """Order, (f0, c) and standard deviation of the fit."""
    weights = np.sqrt(1.0 / h / np.sum(1.0 / h))

    def of(order):
        matrix = np.stack([np.ones_like(h), h ** order], axis=1)
        found = np.linalg.lstsq(weights[:, None] * matrix, weights * f, rcond=None)[0]
        return found, float(np.sum((weights * (f - matrix @ found)) ** 2))

    low, high = ORDERS
    for _ in range(6):  # finer and finer about the best
        orders = np.linspace(low, high, 31)
        best = int(np.argmin([of(order)[1] for order in orders]))
        low, high = orders[max(best - 1, 0)], orders[min(best + 1, 30)]
    order = float(orders[best])
    found, rest = of(order)
    freedom = len(h) - 2 - is_between(order)
    return order, tuple(map(float, found)), float(np.sqrt(len(h) * rest / freedom)) if freedom > 0 else 0.0
