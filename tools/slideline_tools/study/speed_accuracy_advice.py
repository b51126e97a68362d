# SPDX-License-Identifier: MIT
"""What the study speed-accuracy recommends: figures by type over all scenes, and sentences."""
from slideline_tools.studies.common import TYPES, label, markdown_table
from slideline_tools.study.speed_accuracy_front import cheapest, front, geometric_mean, ratios
from slideline_tools.study.speed_accuracy_scenes import SCENES

PRESSURE_SCENES = ("patch", "block")
GLOBAL = (("sliding", "force_error", "force history of the sliding"),
          ("collision", "plastic_error", "plastic work of the collision by columns"),
          ("collision", "total_work_error", "the same in total"))
TARGETS = (0.3, 0.1, 0.03, 0.01, 0.003, 0.001, 0.0003)
FROM_A_TO_B = "{:.2f} to {:.2f}"


class Overview:
    """All points by scene, and what they say of a type."""

    def __init__(self, points):
        """`points`: {scene: [Point]}, see speed_accuracy_front.points_of."""
        self.points = points
        self.types = sorted({point.type for all_of in points.values() for point in all_of})

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

    def cost_by_scene(self, ctype, cost):
        """{scene: time over that of type 1, geometric mean over the meshes}."""
        found = {name: ratios(points, ctype, lambda point: point.cost[cost])
                 for name, points in self.points.items()}
        return {name: geometric_mean(values) for name, values in found.items() if values}

    def cost(self, ctype, cost):
        """Time over that of type 1, geometric mean over the scenes."""
        return geometric_mean(self.cost_by_scene(ctype, cost).values())

    def error(self, ctype, scene, key):
        """Error over that of type 1, geometric mean over the meshes."""
        points = [point for point in self.points.get(scene, ()) if key in point.error]
        return geometric_mean(ratios(points, ctype, lambda point: point.judged(key)))

    def fronts(self, ctype, cost="computing"):
        """On how many fronts the type has a point."""
        return sum(any(point.type == ctype for point in front(self.points[name], cost, measure.key))
                   for name, measure in self.panels())

    def shares(self, scene):
        """Lowest and highest share of contact in the computing time."""
        values = [point.cost["contact"] / point.cost["computing"] for point in self.points[scene]]
        return min(values), max(values)


def number(value):
    """Two digits; an empty text for what is not known."""
    return "" if value != value else f"{value:.2f}" if value >= 0.095 else f"{value:.1g}"


def overall_table(over):
    """One row for each type: costs and errors over those of type 1."""
    rows, panels = [], over.panels()
    for ctype in over.types:
        costs = over.cost_by_scene(ctype, "contact").values()
        passes = over.passes(ctype)
        rows.append([
            label(ctype), "" if passes is None else "yes" if passes else "no",
            f"{over.cost(ctype, 'contact'):.2f} ({FROM_A_TO_B.format(min(costs), max(costs))})"
            if costs else "", number(over.cost(ctype, "computing")),
            *(number(over.error(ctype, scene, key)) for scene, key in COMPARED),
            f"{over.fronts(ctype)} of {len(panels)}"])
    return markdown_table(
        ["type", "exact pressure in patch and block", "contact time", "computing time",
         "Hertz profile", "sliding force", "sliding roughness", "plastic work", "on the fronts"],
        rows)


COMPARED = (("hertz", "profile_error"), ("sliding", "force_error"), ("sliding", "roughness"),
            ("collision", "total_work_error"))


def target_table(over):
    """The cheapest type and mesh, by computing time, for each measure and target."""
    rows = []
    for name, measure in over.panels():
        points = over.points[name]
        found = [cheapest(points, "computing", measure.key, target) for target in TARGETS]
        rows.append([f"{SCENES[name].title}: {measure.title}", *(
            f"{point.name}, {point.cost['computing']:.2g} s" if point else "-" for point in found)])
    return markdown_table(["error at most", *(f"{100 * target:g} %" for target in TARGETS)], rows)


# ---- sentences ---------------------------------------------------------------------------------

def names(types):
    """'type 4', 'types 4, 5 and 7'."""
    words = [str(ctype) for ctype in types]
    if not words:
        return "no type"
    if len(words) == 1:
        return f"type {words[0]}"
    return f"types {', '.join(words[:-1])} and {words[-1]}"


def capital(text):
    return text[:1].upper() + text[1:]


def general_advice(over):
    """The cheapest of the types that transmit a uniform pressure exactly."""
    exact = [ctype for ctype in over.types if over.passes(ctype)]
    if not exact or 1 not in over.types:
        return None, ""
    best = min(exact, key=lambda ctype: over.cost(ctype, "contact"))
    contact = over.cost_by_scene(best, "contact").values()
    run = over.cost_by_scene(best, "computing").values()
    others = [f"type {ctype} takes {over.cost(ctype, 'contact'):.1f} times" for ctype in exact
              if ctype != best]
    text = (f"**In general type {best} ({TYPES[best]}).** {capital(names(exact))} transmit a uniform "
            "pressure exactly on both sides, on every mesh. "
            f"Of them type {best} has the least contact time: {over.cost(best, 'contact'):.1f} times that of "
            f"type 1 as the geometric mean of the scenes ({FROM_A_TO_B.format(min(contact), max(contact))}); "
            f"the whole computation takes {FROM_A_TO_B.format(min(run), max(run))} times that of type 1."
            + (f" For comparison, {', '.join(others)} the contact time of type 1." if others else ""))
    return best, text


def smooth_advice(over, usual):
    """The type with the smoothest force."""
    there = [(over.error(ctype, "sliding", "roughness"), ctype) for ctype in over.types
             if over.error(ctype, "sliding", "roughness") > 0.0]
    if not there or 1 not in over.types:
        return ""
    least, best = min(there)
    more = over.cost_by_scene(best, "computing")["sliding"]
    contact = over.cost_by_scene(best, "contact")["sliding"]
    text = (f"**Where the force must be smooth type {best} ({TYPES[best]}).** In the sliding its roughness "
            f"is {least:.2g} times that of type 1 on the same mesh; contact takes {contact:.1f} times, the "
            f"computation {more:.2f} times as long. ")
    points = [point for point in over.points["sliding"] if "roughness" in point.error]
    coarse = min((point for point in points if point.type == best), key=lambda point: point.level)
    equal = cheapest([point for point in points if point.type == 1], "computing", "roughness",
                     coarse.error["roughness"])
    if equal:
        text += (f"Type 1 gets as smooth as {coarse.name} at N_r = {equal.level}, for "
                 f"{equal.cost['computing'] / coarse.cost['computing']:.1f} times the computing time.")
    else:
        finest = max(point.level for point in points if point.type == 1)
        text += f"Type 1 is at N_r = {finest} not yet as smooth as {coarse.name}."
    if usual not in (None, best):
        text += (f" Type {usual} stands between them: roughness "
                 f"{over.error(usual, 'sliding', 'roughness'):.2g}, computation "
                 f"{over.cost_by_scene(usual, 'computing')['sliding']:.2f} times.")
    return text


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
        least = min(over.types, key=lambda ctype: over.cost(ctype, "contact"))
        text += (f" On a coarse mesh the cheapest type ({least}) will do for them; pressures and local stresses "
                 "of the types that fail the patch test remain wrong on any mesh.")
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


def idle_advice(over):
    """Types that are on no front."""
    idle = [ctype for ctype in over.types if not over.fronts(ctype)]
    if not idle:
        return ""
    return (f"**Nothing asks for {names(idle)}**: in no scene and measure is there a point of "
            f"{'it' if len(idle) == 1 else 'them'} on the Pareto front of computing time; something else is "
            "cheaper and no less accurate.")


def advice(over):
    """The bullets of the recommendation."""
    usual, general = general_advice(over)
    lines = [general, smooth_advice(over, usual), mesh_advice(over), share_advice(over),
             idle_advice(over)]
    return "\n".join(f"- {line}" for line in lines if line)
