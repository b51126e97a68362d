# SPDX-License-Identifier: MIT
"""Fields to draw: from a name such as `plastic_strain`, `velocity:y` or `stress:xy` to scalars."""
import numpy as np

from slideline_tools import UserError
from slideline_tools.names import missing
from slideline_tools.results import STRESS_COMPONENTS, VECTOR_COMPONENTS

# What the number is, and whether it has a unit (that of the deck, whatever it is).
LABELS = {
    "plastic_strain": ("effective plastic strain", False),
    "mises": ("von Mises stress", True),
    "temperature": ("temperature", True),
    "damage": ("damage", False),
    "eroded": ("1: has left the mesh", False),
    "pressure": ("pressure (- trace of stress / 3)", True),
    "stress": ("stress", True),
    "displacement": ("displacement", True),
    "velocity": ("velocity", True),
    "contact_force": ("contact force", True),
    "contact_pressure": ("contact pressure", True),
    "gap": ("contact gap", True),
    "contact_traction": ("friction traction", True),
    "contact_slip": ("slip", True),
    "contact_state": ("0 open, 1 stick, 2 slip, 3 tied, 4 broken", False),
}


#: what is smaller beside the largest value of its kind is round-off
ROUND_OFF = 1.0e-12


def largest(values):
    """The largest size of finite values; 0 without any."""
    sizes = np.abs(values[np.isfinite(values)])
    return float(sizes.max()) if sizes.size else 0.0


def without_round_off(values, scale):
    """The values with zero in place of those that are round-off beside `scale`."""
    return np.where(np.abs(values) < ROUND_OFF * scale, 0.0, values)


class ScalarField:
    """One scalar per node or cell and state.

    `values` (n_state, n), `at_nodes`, `label` for a colour bar, `limits` over all states.
    """

    def __init__(self, values, at_nodes, label):
        self.values = np.asarray(values, dtype=float)
        self.at_nodes = at_nodes
        self.label = label

    def limits(self, states=None):
        """(lowest, highest) over the given states; about zero if the field has both signs."""
        values = self.values if states is None else self.values[states]
        low, high = min(float(np.min(values)), 0.0), max(float(np.max(values)), 0.0)
        if low < 0.0 < high:
            high = max(-low, high)
            return -high, high
        return (low, high) if high > low else (0.0, 1.0)


def scalar_field(results, name):
    """The field `name` or `name:component`; without component the length of a vector."""
    base, _, component = name.partition(":")
    if base in results.point_fields:
        values, at_nodes, components = results.point_field(base), True, VECTOR_COMPONENTS
    elif base in results.cell_fields:
        values, at_nodes, components = results.cell_field(base), False, STRESS_COMPONENTS
    else:
        present = results.point_fields + results.cell_fields
        raise UserError(f"no field '{base}'{missing(base, present)}")
    text, has_unit = LABELS.get(base, (base.replace("_", " "), True))
    values = without_round_off(values, largest(values))
    if values.ndim == 3:
        values, text = pick_component(base, values, component, components, text)
    elif component:
        raise UserError(f"field '{base}' has no components")
    return ScalarField(values, at_nodes, text + (" (deck units)" if has_unit else ""))


def pick_component(base, values, component, names, text):
    """One component, or the length of a vector if none is asked for."""
    if component in names:
        return values[:, :, names.index(component)], f"{text} {component}"
    if component or values.shape[2] == 6:
        choices = ", ".join(f"{base}:{one}" for one in names[:values.shape[2]])
        raise UserError(f"which component of '{base}'? choose one of {choices}")
    return np.linalg.norm(values, axis=2), f"{text}, magnitude"


def default_field(results):
    """Name of the field worth showing first: plastic strain if there is any, else mises."""
    if "plastic_strain" in results.cell_fields and np.any(results.cell_field("plastic_strain") > 0.0):
        return "plastic_strain"
    return "mises" if "mises" in results.cell_fields else "displacement"
