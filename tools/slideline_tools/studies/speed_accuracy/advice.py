# SPDX-License-Identifier: MIT
"""What the study speed-accuracy recommends: figures by type over all scenes, and sentences.

Which types are named is decided by framework/rules.py alone.
"""
from slideline_tools.contact_types import IMPLICIT_PENALTIES, SERIES, in_order
from slideline_tools.studies.common import label, markdown_table
from slideline_tools.studies.framework.rules import (COST_FACTOR, ERROR_FACTOR, RUN_FACTOR, between, least, names,
                                                   numbers)
from slideline_tools.studies.speed_accuracy.front import cheapest, geometric_mean, meeting, ratios
from slideline_tools.studies.speed_accuracy.scenes import SCENES

PRESSURE_SCENES = ("patch", "block")
GLOBAL = (("sliding", "force_error", "force history of the sliding"),
          ("collision", "plastic_error", "plastic work of the collision by columns"),
          ("collision", "total_work_error", "the same in total"))
COMPARED = (("hertz", "profile_error", "Hertz profile"),
            ("sliding", "force_error", "sliding force"),
            ("sliding", "roughness", "sliding roughness"),
            ("collision", "total_work_error", "plastic work"))
TARGETS = (0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003)
BESIDE = 7  # what implicit penalty is compared with: the same weighted gaps
BALANCED = 1.0e-9  # a net moment that is round-off


class Overview:
    """All points by scene, and what they say of a type."""

    def __init__(self, points):
        """`points`: {scene: [Point]}, see front.points_of."""
        self.points = points
        self.types = in_order(point.type for all_of in points.values() for point in all_of)

    def panels(self):
        """(scene, measure) of every measure that has points."""
        return [(name, measure) for name, points in self.points.items()
                for measure in SCENES[name].measures
                if any(measure.key in point.error for point in points)]

    def passes(self, ctype):
        """Whether the pressure is exact to round-off in patch and block on every mesh; None if
        neither has run."""
        exact = [not point.resolved("pressure_error") for name in PRESSURE_SCENES
                 for point in self.points.get(name, ()) if point.type == ctype]
        return all(exact) if exact else None

    def cost_by_scene(self, ctype, cost, base=1):
        """{scene: time over that of type `base`, geometric mean over the meshes}."""
        found = {name: ratios(points, ctype, lambda point: point.cost[cost], base)
                 for name, points in self.points.items()}
        return {name: geometric_mean(values) for name, values in found.items() if values}

    def cost(self, ctype, cost):
        """Time over that of type 1, geometric mean over the scenes."""
        return geometric_mean(self.cost_by_scene(ctype, cost).values())

    def error(self, ctype, scene, key, base=1):
        """Error over that of type `base`, geometric mean over the meshes."""
        points = [point for point in self.points.get(scene, ()) if key in point.error]
        return geometric_mean(ratios(points, ctype, lambda point: point.judged(key), base))

    def moment(self, ctype):
        """Largest net moment of the contact forces, over force times slave segment; nan where no
        run tells it."""
        return max((point.moment for points in self.points.values() for point in points
                    if point.type == ctype and point.moment == point.moment), default=float("nan"))

    def shares(self, scene):
        """Lowest and highest share of contact in the computing time."""
        values = [point.cost["contact"] / point.cost["computing"] for point in self.points[scene]]
        return min(values), max(values)


def number(value):
    """Two digits; an empty text for what is not known."""
    return "" if value != value else f"{value:.2f}" if value >= 0.095 else f"{value:.1g}"


def moment_text(value):
    """A net moment; round-off by its bound."""
    return "" if value != value else f"{value:.1g}" if value > BALANCED else f"< {BALANCED:.0e}"


def overall_table(over):
    """One row for each type: costs and errors over those of type 1, and the net moment."""
    rows = []
    for ctype in over.types:
        costs = over.cost_by_scene(ctype, "contact").values()
        passes = over.passes(ctype)
        rows.append([
            label(ctype), "" if passes is None else "yes" if passes else "no",
            f"{over.cost(ctype, 'contact'):.2f} ({between(costs)})" if costs else "",
            number(over.cost(ctype, "computing")),
            *(number(over.error(ctype, scene, key)) for scene, key, _ in COMPARED),
            moment_text(over.moment(ctype))])
    return markdown_table(
        ["type", "exact pressure in patch and block", "contact time", "computing time",
         *(title for *_, title in COMPARED), "net moment"], rows)


def target_table(over):
    """The cheapest types and mesh, by computing time, for each measure and target."""
    rows = []
    for name, measure in over.panels():
        points = over.points[name]
        rows.append([f"{SCENES[name].title}: {measure.title}", *(
            target_cell(over, meeting(points, measure.key, target)) for target in TARGETS)])
    return markdown_table(["error at most", *(f"{100 * target:g} %" for target in TARGETS)], rows)


def target_cell(over, points):
    """'4 5 7/1, 0.017 s': all points whose computing time is alike, and the shortest time."""
    costs = {point.name: point.cost["computing"] for point in points}
    found = [point for point in points if point.name in least(costs, RUN_FACTOR)]
    if not found:
        return "-"
    parts = []
    for level in sorted({point.level for point in found}):
        types = in_order(point.type for point in found if point.level == level)
        parts.append(("all" if types == over.types and len(types) > 1 else " ".join(map(str, types)))
                     + f"/{level}")
    return f"{', '.join(parts)}, {min(costs.values()):.2g} s"


# ---- sentences ---------------------------------------------------------------------------------

def capital(text):
    return text[:1].upper() + text[1:]


def chosen_types(over):
    """Of the types with exact pressure those whose contact costs the least, or nearly."""
    exact = [ctype for ctype in over.types if over.passes(ctype)]
    if not exact or 1 not in over.types:
        return []
    return least({ctype: over.cost(ctype, "contact") for ctype in exact}, COST_FACTOR)


def cost_text(over, ctype):
    """'type 4 2.49 times that of type 1 (1.94 to 4.10 from scene to scene)'."""
    return (f"type {ctype} {over.cost(ctype, 'contact'):.2f} "
            f"({between(over.cost_by_scene(ctype, 'contact').values())})")


def scene_text(over, chosen):
    """Which of two types is the cheaper one, scene by scene; '' unless there are two."""
    if len(chosen) != 2:
        return ""
    one, other = (over.cost_by_scene(ctype, "contact") for ctype in chosen)
    parts = [f"{one[name] / other[name]:.2f} in {SCENES[name].title}" for name in one if name in other]
    return f" By scene type {chosen[0]} takes {', '.join(parts)} times as long as type {chosen[1]}."


def accuracy_text(over, chosen):
    """Which of the chosen types has the smaller errors."""
    winners = {}
    for scene, key, title in COMPARED:
        errors = {ctype: over.error(ctype, scene, key) for ctype in chosen}
        if len(chosen) > 1 and all(value == value for value in errors.values()):
            text = f"{title} ({', '.join(number(value) for value in errors.values())})"
            winners.setdefault(tuple(least(errors, ERROR_FACTOR)), []).append(text)
    if not winners:
        return ""
    parts = [("alike" if len(best) == len(chosen) else f"smaller with {names(best)}")
             + f" in {', '.join(texts)}" for best, texts in winners.items()]
    return (f"Errors over those of type 1, of {names(chosen)}: {'; '.join(parts)}. "
            f"Less than a factor of {ERROR_FACTOR:g} counts as alike.")


def moment_advice(over, chosen):
    """Of which of the chosen types the contact forces have a net moment."""
    moments = {ctype: over.moment(ctype) for ctype in chosen}
    if not chosen or any(value != value for value in moments.values()):
        return ""
    turning = [ctype for ctype, value in moments.items() if value > BALANCED]
    rest = [ctype for ctype in chosen if ctype not in turning]
    if not turning or not rest:
        return ""
    largest = max(moments[ctype] for ctype in turning)
    return (f"On a bent master the contact forces of {names(turning)} have a net moment, here up to {largest:.1g} of "
            f"the contact force times a slave segment; with {names(rest)} it is round-off ([contact](../theory/contact.md), "
            "section 5.4).")


def general_advice(over):
    """The cheapest of the types that transmit a uniform pressure exactly, and what tells them apart."""
    chosen = chosen_types(over)
    if not chosen:
        return [], ""
    exact = [ctype for ctype in over.types if over.passes(ctype)]
    rest = [ctype for ctype in exact if ctype not in chosen]
    run = [value for ctype in chosen for value in over.cost_by_scene(ctype, "computing").values()]
    named = ", ".join(SERIES[ctype] for ctype in chosen)
    text = (f"**In general type {numbers(chosen, 'or')} ({named}).** {capital(names(exact))} "
            f"transmit{'s' * (len(exact) == 1)} a uniform pressure exactly on both sides, on every mesh. ")
    cost = ("Contact time over that of type 1, geometric mean of the scenes (from scene to scene): "
            + ", ".join(cost_text(over, ctype) for ctype in exact)
            + f". Means that differ by less than a factor of {COST_FACTOR:g} count as alike"
            + (f", so {names(rest)} {'is' if len(rest) == 1 else 'are'} dearer" if rest else "")
            + (f" and {names(chosen)} are not told apart." if len(chosen) > 1 else ".")
            + scene_text(over, chosen)
            + f" The whole computation takes {between(run)} times that of type 1.")
    parts = [cost, accuracy_text(over, chosen), moment_advice(over, chosen)]
    return chosen, "\n  - ".join([text.rstrip(), *(part for part in parts if part)])


def smooth_advice(over, usual):
    """The type with the smoothest force."""
    rough = {ctype: over.error(ctype, "sliding", "roughness") for ctype in over.types}
    rough = {ctype: value for ctype, value in rough.items() if value > 0.0}
    if not rough or 1 not in over.types:
        return ""
    smoothest = least(rough, ERROR_FACTOR)
    costs = over.cost_by_scene
    text = (f"**Where the force must be smooth type {numbers(smoothest, 'or')}.** Roughness in the sliding over that of type 1 on the "
            "same mesh, and times of contact and computation: "
            + "; ".join(f"type {ctype} {rough[ctype]:.2g}, {costs(ctype, 'contact')['sliding']:.1f} times, "
                        f"{costs(ctype, 'computing')['sliding']:.2f} times"
                        for ctype in dict.fromkeys([*smoothest, *usual])) + ". ")
    best = min(smoothest, key=rough.get)
    points = [point for point in over.points["sliding"] if "roughness" in point.error]
    coarse = min((point for point in points if point.type == best), key=lambda point: point.level)
    equal = cheapest([point for point in points if point.type == 1], "computing", "roughness",
                     coarse.error["roughness"])
    if equal:
        return text + (f"Type 1 gets as smooth as {coarse.name} at N_r = {equal.level}, for "
                       f"{equal.cost['computing'] / coarse.cost['computing']:.1f} times the computing time.")
    finest = max(point.level for point in points if point.type == 1)
    return text + f"Type 1 is at N_r = {finest} not yet as smooth as {coarse.name}."


def mesh_advice(over):
    """For global answers: what the type changes beside what the mesh changes."""
    lines, first = [], []
    for scene, key, title in GLOBAL:
        points = [point for point in over.points.get(scene, ()) if key in point.error]
        levels = sorted({point.level for point in points})
        if len(levels) < 2:
            continue
        ends = [[point.judged(key) for point in points if point.level == level]
                for level in (levels[0], levels[-1])]
        coarse, fine = (max(values) / min(values) for values in ends)
        gain = geometric_mean(ends[0]) / geometric_mean(ends[1])
        first.append(gain > coarse)
        lines.append(f"{title}: errors of the types differ by a factor of {coarse:.1f} at N_r = "
                     f"{levels[0]} and {fine:.1f} at N_r = {levels[-1]}, and fall by a factor of "
                     f"{gain:.1f} from the one to the other")
    if not lines:
        return ""
    if not all(first):
        return "**For global answers mesh and type both count.** " + capital("; ".join(lines)) + "."
    text = "**For global answers refine first.** " + capital("; ".join(lines)) + "."
    if 1 in over.types:
        few = least({ctype: over.cost(ctype, "contact") for ctype in over.types}, COST_FACTOR)
        text += f" On a coarse mesh the cheapest {names(few)} will do for them."
    failing = [ctype for ctype in over.types if over.passes(ctype) is False]
    if failing:
        text += f" The pressures of {names(failing)} have an error on every mesh of the patch test (below)."
    return text


def share_advice(over):
    """How much of a run contact is."""
    parts = []
    for scene, points in over.points.items():
        low, high = over.shares(scene)
        levels = sorted({point.level for point in points})
        step = [geometric_mean(point.cost["computing"] for point in points if point.level == level)
                for level in levels]
        rise = f", {step[-1] / step[0]:.0f} times the time from N_r = {levels[0]} to {levels[-1]}" \
            if len(levels) > 1 else ""
        parts.append(f"{SCENES[scene].title} {100 * low:.0f} to {100 * high:.0f} %{rise}")
    return ("**What a dearer type costs** depends on the share of contact in the computation: "
            + "; ".join(parts) + ". Where it is small, take the type for its accuracy alone.")


def outdone(over, ctype):
    """The types that cost less than this one and err less or alike in every measure."""
    found = []
    for other in over.types:
        pairs = [(over.error(other, scene, key), over.error(ctype, scene, key))
                 for scene, key, _ in COMPARED]
        if other != ctype and over.passes(other) >= over.passes(ctype) and all(
                one <= ERROR_FACTOR * two for one, two in pairs) \
                and over.cost(ctype, "contact") > COST_FACTOR * over.cost(other, "contact"):
            found.append(other)
    return found


def implicit_advice(over):
    """Implicit penalty beside the springs of the same type: cost and errors over those of type 7."""
    there = [ctype for ctype in over.types if ctype in IMPLICIT_PENALTIES]
    if not there or BESIDE not in over.types:
        return ""
    parts = []
    for ctype in there:
        contact, run = (over.cost_by_scene(ctype, cost, BESIDE) for cost in ("contact", "computing"))
        errors = [f"{title} {number(value)}" for scene, key, title in COMPARED
                  if (value := over.error(ctype, scene, key, BESIDE)) == value]
        parts.append(f"type {ctype} (PEN {pen_text(ctype)}): contact {between(contact.values())} times and the whole run "
                     f"{between(run.values())} times that of type {BESIDE}"
                     + (f"; errors over its: {', '.join(errors)}" if errors else ""))
    return (f"**Implicit penalty (PUNIT 4), {names(there)},** is type {BESIDE} with springs that push by the gap of the end of "
            "the step. From scene to scene " + ". ".join(parts[:1]) + "".join(f"; {part}" for part in parts[1:])
            + ". All take the same steps here, which the penalties of these decks allow. Stiffer springs of the other types want "
            "smaller steps, those of PUNIT 4 do not ([stability](stability.md)); that is not in these figures.")


def pen_text(ctype):
    """'10', 'below 0'."""
    pen = IMPLICIT_PENALTIES[ctype]
    return f"{pen:g}" if pen > 0.0 else "below 0, no compliance"


def idle_advice(over):
    """Types that another one beats in cost without losing in accuracy anywhere."""
    if any(over.passes(ctype) is None for ctype in over.types):
        return ""
    lines = [f"type {ctype} ({names(found)})" for ctype in over.types
             if (found := outdone(over, ctype))]
    if not lines:
        return ""
    return ("**Outdone in these scenes**, by a type with cheaper contact and no larger error in any column of the table: "
            + ", ".join(lines) + ".")


def advice(over):
    """The bullets of the recommendation."""
    usual, general = general_advice(over)
    lines = [general, smooth_advice(over, usual), implicit_advice(over), mesh_advice(over), share_advice(over),
             idle_advice(over)]
    return "\n".join(f"- {line}" for line in lines if line)
