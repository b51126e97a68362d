# SPDX-License-Identifier: MIT
"""Advice on parts: laws, viscosity, rigid bodies, symmetry."""
import numpy as np

from slideline_tools.advise.report import Advice
from slideline_tools.effective_deck import material_keyword

# What a plastic law and bulk viscosity add to a one-point quad, in elastic ones without
# viscosity. Measured in turn on meshes of 960 and 3840 elements: 0.05 to 0.2, 0.5 to 0.6.
PLASTIC_EXTRA, VISCOUS_EXTRA = 0.1, 0.5
# Laws that are not those of metals: an elastic one would not do in their place, or they are it.
NOT_OF_METALS = ("elastic", "rigid", "fluid", "Mooney-Rivlin rubber", "Blatz-Ko rubber", "crushable foam")
# Largest viscous energy over the largest total energy that says: without effect.
NO_VISCOUS_ENERGY = 1.0e-4
# Strain and internal energy of a part over the largest of all parts that say: rigid.
RIGID_STRAIN, RIGID_ENERGY = 0.01, 0.01
# Largest difference of mirrored displacements over the largest displacement: symmetric.
SYMMETRIC = 1.0e-3


def extras(run, part) -> tuple[float, float]:
    """What its law and its viscosity add to an element of a part, in elastic elements."""
    glstat = run.tables.get("glstat")
    viscous = glstat is not None and bool(np.any(glstat["viscous"]))
    return PLASTIC_EXTRA * (part.law not in NOT_OF_METALS), VISCOUS_EXTRA * (viscous and not part.is_rigid)


def element_seconds(run, worth: dict[int, float | None]) -> float:
    """Seconds of the element loop that belong to `worth`: by part, the cost per element in
    elastic elements (None: all of it)."""
    weights, total = 0.0, 0.0
    for part in run.parts:
        count = part.n_element
        whole = 1.0 + sum(extras(run, part))
        total += count * whole
        if part.id in worth:
            weights += count * (whole if worth[part.id] is None else worth[part.id])
    return run.seconds_of("elements") * weights / max(total, 1.0)


def never_yielded(run) -> list[Advice]:
    """Plastic laws of parts whose plastic strain is exactly zero at the last state."""
    if run.results is None or "plastic_strain" not in run.results.cell_fields:
        return []
    parts = run.results.cell_field("part_id")[0]
    strain, mises = run.results.cell_field("plastic_strain")[-1], run.results.cell_field("mises")
    advice = []
    for part in run.parts:
        own = parts == part.id
        if part.law in NOT_OF_METALS or not own.any() or strain[own].max() > 0.0:
            continue
        others = [other.id for other in run.parts
                  if other.material == part.material and other.id != part.id]
        shared = (f" (a material of its own: parts {', '.join(map(str, others))} share it)"
                  if others else "")
        advice.append(Advice(
            "never yielded", f"{part.label} never yielded: its law could be elastic.",
            f"plastic strain 0 in all {own.sum()} elements at the end; largest Mises stress at "
            f"{len(mises)} states {mises[:, own].max():.3g}",
            f"material {part.material}: *MAT_ELASTIC with the same MID, RO, E, PR in place of "
            f"{material_keyword(run.deck, part.material)}{shared}",
            element_seconds(run, {part.id: PLASTIC_EXTRA}),
            f"a plastic element costs {1.0 + PLASTIC_EXTRA} elastic ones"))
    return advice


def idle_viscosity(run) -> list[Advice]:
    """Bulk viscosity that took no energy."""
    numbers = [part.id for part in run.parts if not part.is_rigid]
    glstat = run.tables.get("glstat")
    if not numbers or run.is_implicit or glstat is None or len(glstat) < 3:
        return []
    largest, viscous = np.abs(glstat["total"]).max(), np.abs(glstat["viscous"]).max()
    if not 0.0 < viscous <= NO_VISCOUS_ENERGY * largest:  # exactly 0: there is none
        return []
    return [Advice(
        "bulk viscosity", "Bulk viscosity took no energy worth naming.",
        f"largest viscous energy {viscous:.3g}, largest total energy {largest:.3g}",
        "leave *CONTROL_BULK_VISCOSITY out, or Q1 = Q2 = 0.0 there and in *HOURGLASS",
        element_seconds(run, dict.fromkeys(numbers, VISCOUS_EXTRA)),
        f"it adds {VISCOUS_EXTRA} elastic elements to an element; the step limit grows, too")]


def nearly_rigid(run) -> list[Advice]:
    """Parts that hardly deform beside the others."""
    matsum, results = run.tables.get("matsum"), run.results
    if (results is None or run.is_implicit or matsum is None or len(run.parts) < 2
            or "mises" not in results.cell_fields):
        return []
    cell_part, mises = results.cell_field("part_id")[0], results.cell_field("mises")
    plastic = (results.cell_field("plastic_strain") if "plastic_strain" in results.cell_fields
               else np.zeros_like(mises))
    strains, energies = {}, {}
    for part in run.parts:
        own = cell_part == part.id
        rows = matsum.where(part=part.id)
        if not own.any() or part.young <= 0.0 or not len(rows):
            return []
        strains[part.id] = float((mises[:, own] / part.young + plastic[:, own]).max())
        energies[part.id] = float(rows["internal"].max())
    advice = []
    for number, strain in strains.items():
        if (0.0 < strain <= RIGID_STRAIN * max(strains.values())
                and energies[number] <= RIGID_ENERGY * max(energies.values())):
            part = run.model.parts[number]
            advice.append(Advice(
                "rigid", f"{part.label} moved nearly as a rigid body.",
                f"largest strain {strain:.2g} (of all parts {max(strains.values()):.2g}), largest "
                f"internal energy {energies[number]:.2g} (of all parts "
                f"{max(energies.values()):.2g})",
                f"material {part.material}: *MAT_RIGID, if the waves in this part do not matter",
                element_seconds(run, {number: None}),
                "its elements need no stress update: at most"))
    return advice


def mirror_pairs(points: np.ndarray, axis: int) -> np.ndarray | None:
    """Node that each node falls upon when the mesh is mirrored about its middle; None if any
    falls beside. `axis` 0 mirrors x, 1 mirrors y."""
    size = float(np.ptp(points, axis=0).max())
    if size == 0.0:
        return None
    middle = 0.5 * (points[:, axis].min() + points[:, axis].max())
    mirrored = points.copy()
    mirrored[:, axis] = 2.0 * middle - points[:, axis]
    grain = 1.0e-7 * size
    order, image = (np.lexsort(np.floor(where / grain + 0.318).T[[1, 0]])
                    for where in (points, mirrored))
    if np.abs(points[order] - mirrored[image]).max() > 2.0 * grain:
        return None
    pairs = np.empty(len(points), dtype=int)
    pairs[image] = order
    return pairs


def mirrored_cells(cells: np.ndarray, pairs: np.ndarray) -> np.ndarray | None:
    """Element that each element falls upon; None if any falls beside."""
    own, image = np.sort(cells, axis=1), np.sort(pairs[cells], axis=1)
    first, second = np.lexsort(own.T), np.lexsort(image.T)
    if not np.array_equal(own[first], image[second]):
        return None
    match = np.empty(len(cells), dtype=int)
    match[second] = first
    return match


def symmetric(run) -> list[Advice]:
    """Mesh, parts and displacements at all states that are their own mirror images."""
    results = run.results
    if results is None or len(results.times) < 3:
        return []
    start, moved = results.points[0][:, :2], results.point_field("displacement")[:, :, :2]
    start = start - moved[0]
    largest = float(np.abs(moved).max())
    if largest == 0.0:
        return []
    advice = []
    for axis, name in ((0, "x"), (1, "y")):
        pairs = mirror_pairs(start, axis)
        match = None if pairs is None else mirrored_cells(results.cells, pairs)
        if match is None or np.any(match == np.arange(len(match))):  # an element across the cut
            continue
        parts = results.cell_field("part_id")[0]
        sign = np.where(np.arange(2) == axis, -1.0, 1.0)
        error = float(np.abs(moved[:, pairs] - sign * moved).max()) / largest
        if error > SYMMETRIC or not np.array_equal(parts, parts[match]):
            continue
        middle = 0.5 * (start[:, axis].min() + start[:, axis].max())
        saved = 0.5 * (run.seconds_of("loop") + run.seconds_of("output")
                       + run.seconds_of("solver"))
        advice.append(Advice(
            "symmetry", f"Model and results are symmetric about {name} = {middle:.4g}: half the "
            "model would do.",
            f"every node and element has its mirror image; displacements differ by {error:.1g} of "
            f"the largest at {len(moved)} states",
            f"keep one side of {name} = {middle:.4g} and fix u_{name} of the nodes on it by "
            "*BOUNDARY_SPC_SET; forces and energies halve", saved,
            "half of elements, nodes, contact and output"))
    return advice


CHECKS = (never_yielded, idle_viscosity, nearly_rigid, symmetric)
