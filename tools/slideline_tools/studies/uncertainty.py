# SPDX-License-Identifier: MIT
"""Whether the uncertainty of `answer` is true: three cheap runs of each scene against a closed form or a run four times finer
than the finest of them (twice where that takes over half an hour)."""
import dataclasses
import math
import pathlib
import re
import subprocess
import tempfile
from typing import Callable, Mapping, Optional

import pandas as pd

from slideline_tools import scenes
from slideline_tools.answer.estimate import estimate
from slideline_tools.answer.meshes import Meshes
from slideline_tools.answer.quantity import parse
from slideline_tools.plots import COLOURS, PAGE_WIDTH, STYLE, plt
from slideline_tools.program import Outcome, find_program
from slideline_tools.studies.common import markdown_table, save_small, verification
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.framework.pages import ROOT
from slideline_tools.studies.framework.table import finished

MESHES = (1, 2, 3)
FORCE = "rcforc:{}@interface=1,side=slave:{}"


@dataclasses.dataclass(frozen=True)
class Scene:
    """A deck, the quantities asked of it with their closed forms (None: those of the `finest` mesh), and options of the program."""

    deck: Callable[[], str]
    asked: Mapping[str, Optional[float]]
    finest: int = 12
    options: tuple = ()


def own(path):
    """The text of a deck of the tree, its includes by their full paths."""
    folder = (ROOT / path).parent
    lines = (ROOT / path).read_text(encoding="utf-8").splitlines()
    for k, line in enumerate(lines[:-1]):
        if line.strip().upper() == "*INCLUDE":
            lines[k + 1] = str(folder / lines[k + 1].strip())
    return "\n".join(lines) + "\n"


def verified(case, name, *arguments, module="check", more="", **named):
    """The deck of a verification case."""
    made = getattr(verification(case, module), name)(*arguments, **named)
    return (made[0] if isinstance(made, tuple) else made).text().replace("*END", f"{more}*END")


def plate(law):
    """The plate on two pins."""
    return Scene(lambda: own(f"input/symmetric_plate/plate_8x4_{law}.k"), dict.fromkeys((
        "nodout:uy@node=5:largest", "nodout:uy@node=3:largest", "glstat:internal:largest", "glstat:kinetic:largest")))


def thick_ring(n_r, n_t):
    """A quarter of a thick ring under internal pressure: displacements of Lame at both radii."""
    case = verification("ring")
    more = f"*DATABASE_NODOUT\n1.0,\n*DATABASE_HISTORY_NODE\n1,{n_r + 1}\n"
    return Scene(lambda: verified("ring", "ring_deck", n_r, n_t, more=more), {
        f"nodout:ux@node={node}:end": case.lame_displacement(r) for node, r in ((1, case.INNER), (n_r + 1, case.OUTER))})


def rolling():
    """A disc is set on the level with 1 m/s and no spin, and slides until it rolls with two thirds of that: momentum and friction of
    a rigid disc of radius 1 m."""
    mass = 1000.0 * math.pi
    return Scene(lambda: verified("friction", "rolling", 7, 0.2, 0.0, 1.0, 0.5, 2.0, module="rolling", cells=3), {
        "matsum:momentum_x@part=1:end": 2.0 / 3.0 * mass, "glstat:friction:end": mass / 6.0})


SCENES = {
    "two bars": Scene(lambda: own("doc/examples/contact_2d_slideline.k"), {
        "rcforc:fx@interface=1,side=master:impulse": 50.0, "matsum:momentum_x@part=2:end": 50.0, "glstat:internal:largest": 6.25,
        "matsum:kinetic@part=2:end": 12.5}),
    "bar on a wall": Scene(lambda: own("doc/examples/rigidwall_planar.k"), dict.fromkeys((
        "rwforc:impulse:end", "matsum:momentum_x@part=1:end", "glstat:internal:largest"))),
    "block to a stop": Scene(lambda: own("doc/examples/contact_2d_slideline_friction.k"), {
        "glstat:friction:end": 6.25, "nodout:ux@node=3:end": None}),
    "thick ring, facets of 22 degrees": thick_ring(2, 4),
    "thick ring": thick_ring(4, 6),
    "press fit": Scene(lambda: own("input/press_fit/press_fit.k"), dict.fromkeys((
        "field:displacement:largest", "field:contact_pressure@x=0.05,y=0:end", "field:displacement:x@x=0.1,y=0:end"))
        | {FORCE.format("fx", "end"): None}),
    "plate with a hole": Scene(lambda: own("input/plate_hole/plate_hole.k"), dict.fromkeys((
        "glstat:internal:end", "field:displacement:largest", "field:stress:xx@x=0,y=0.02:end"))),
    "ring in flight": Scene(lambda: own("doc/examples/expanding_ring.k"), {"nodout:x@node=5:largest": None, "glstat:kinetic:mean": None}),
    "plate impact": Scene(lambda: own("doc/examples/plate_impact_spall.k"), dict.fromkeys((
        "nodout:vx@node=121:largest", "nodout:vx@node=121:at=5e-7", "glstat:internal:end"))),
    "block to block": Scene(lambda: own("input/block/block.k"), dict.fromkeys((
        "glstat:internal:end", FORCE.format("fy", "impulse"), FORCE.format("fy", "end"), "matsum:internal@part=1:end"))),
    "patch 3/2": Scene(lambda: own("input/patch/patch_3_2.k"), dict.fromkeys((FORCE.format("fy", "end"), "glstat:internal:end"))),
    "plate, elastic": plate("elastic"),
    "plate, plastic": plate("elastoplastic"),
    "Taylor": Scene(lambda: scenes.taylor(columns=5, rows=50), dict.fromkeys((
        "nodout:uy@node=301:end", "nodout:ux@node=6:end", "glstat:internal:end", "field:plastic_strain:largest"))),
    "Taylor with heat": Scene(lambda: own("doc/examples/taylor_johnson_cook.k"), dict.fromkeys((
        "nodout:uy@node=306:end", "nodout:x@node=6:end", "field:temperature:largest"))),
    "collision": Scene(lambda: own("input/collision/collision.k"), dict.fromkeys((
        FORCE.format("fy", "impulse"), "glstat:internal:end", "nodout:uy@node=5:smallest", "glstat:kinetic:end")), options=("ctype=5",)),
    "cylinder on block": Scene(lambda: scenes.hertz(), dict.fromkeys((
        FORCE.format("fy", "end"), "glstat:internal:end", "field:contact_pressure:largest")), options=("ctype=5",)),
    "sliding die": Scene(lambda: own("input/sliding/sliding.k"), dict.fromkeys((
        FORCE.format("fy", "at=1.5e-3"), FORCE.format("fy", "impulse"), FORCE.format("fx", "impulse"), "glstat:internal:end")), options=("p:dt=8e-8",),
        finest=6),
    "rolling": rolling(),
    "stick-slip": Scene(lambda: verified("", "block_on_belt", 5, module="stick_slip"), dict.fromkeys((
        "nodout:ux:largest", "nodout:ux:smallest", "nodout:ux:mean", "glstat:friction:end"))),
    "impact of spheres": Scene(lambda: verified("hertz_impact", "collision", 7, edge=0.2e-3, grown=(7, 9)), dict.fromkeys((
        FORCE.format("fy", "largest"), FORCE.format("fy", "impulse"), "glstat:internal:largest")), finest=6),
    "ironing": Scene(lambda: verified("ironing", "ironing", 7, 60.0, 120.0, reach=2.0, level=1), dict.fromkeys((
        FORCE.format("fy", "at=0.072"), FORCE.format("fy", "impulse"), FORCE.format("fx", "impulse"), "glstat:friction:end")),
        finest=6),
    "penetration": Scene(lambda: verified("penetration", "plate_and_rod", 300.0, 1.0e-3), dict.fromkeys((
        "matsum:momentum_y@part=2:end", "glstat:internal:end", "glstat:eroded:end"))),
    "folding tube": Scene(lambda: verified("self_contact", "tube", 7, True, module="scenes", rows=24), dict.fromkeys((
        "glstat:external_work:end", "glstat:internal:end", "glstat:external_work:at=0.1835"))),
}


# ---- runs ------------------------------------------------------------------------------------

def jobs(options):
    """The three meshes and the finest one of each scene; the quick study has two scenes without the latter."""
    listed, program = [], options.program or find_program()
    for name in list(SCENES)[:2] if options.quick else SCENES:
        scene, stem = SCENES[name], re.sub(r"\W+", "_", name)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "scene.k")
            path.write_text(scene.deck(), encoding="utf-8")
            subprocess.run([program, f"i={path}", f"d={folder}/mesh_1", "quiet=1", "c=1", *scene.options], capture_output=True, check=False)
            meshes = Meshes(path, pathlib.Path(folder), program)
            needs_finest = any(value is None for value in scene.asked.values()) and not options.quick
            for mesh in (*MESHES, *[scene.finest] * needs_finest):
                deck = meshes.deck_of(mesh)[0] if mesh > 1 else pathlib.Path(folder, "mesh_1", "scene.effective.k")
                listed.append(Job(f"{stem}_{mesh}", deck.read_text(encoding="utf-8"), "scene", ("ncpu=1",),
                                  {"scene": name, "mesh": mesh}, cost=mesh ** 3.0))
    return sorted(listed, key=lambda job: job.labels["mesh"])


def measure(job, folder):
    """The values of all quantities of the scene."""
    outcome = Outcome(folder, "scene", {}, 0, "")
    return {text: parse(text).of(outcome) for text in SCENES[job.labels["scene"]].asked}


def judged(table):
    """A row for each quantity: answer, uncertainty, order, the truth and whether it holds."""
    runs = finished(table).set_index(["scene", "mesh"])
    rows = []
    for name, scene in SCENES.items():
        if not all((name, mesh) in runs.index for mesh in MESHES):
            continue
        for text, closed in scene.asked.items():
            if closed is None and (name, scene.finest) not in runs.index:
                continue
            values = [float(runs.loc[(name, mesh), text]) for mesh in MESHES]
            found = estimate(MESHES, values)
            truth = closed if closed is not None else float(runs.loc[(name, scene.finest), text])
            error = abs(found.value - truth)
            rows.append({"scene": name, "quantity": text, "answer": found.value, "U, %": 100.0 * found.relative, "order": found.order,
                         "error, %": 100.0 * error / abs(found.value), "U/error": found.uncertainty / error if error else float("inf"),
                         "judged by": "closed form" if closed is not None else f"mesh {scene.finest}", "held": bool(error <= found.uncertainty)})
    return pd.DataFrame(rows)


# ---- chart and page --------------------------------------------------------------------------

def chart(table, folder):
    """U over the true error of all quantities."""
    found = judged(table)
    if not len(found):
        return
    found.to_csv(folder / "quantities.csv", index=False)
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(PAGE_WIDTH, 4.2), layout="constrained")
        for held, colour, words in ((True, COLOURS[0], "within U"), (False, COLOURS[1], "missed")):
            some = found[found["held"] == held]
            axes.plot(some["error, %"].clip(lower=1e-4), some["U, %"].clip(lower=1e-4), "o", color=colour, label=f"{words}: {len(some)}")
        axes.plot([1e-4, 1e2], [1e-4, 1e2], color="black", linewidth=0.5)
        axes.set(xscale="log", yscale="log", xlabel="true error of the answer, %", ylabel="uncertainty U, %")
        axes.legend()
        save_small(figure, folder / "uncertainty.png", lines=True)


PAGE = """# Is the uncertainty true?

Tables of `tools/study.sh uncertainty`: [answer](../answer.md) on meshes 1, 2 and 3 of {scenes} scenes, against a closed form or a finer mesh.

![Uncertainty over true error](../pictures/uncertainty.png)

{held} of {count} quantities are within U ({share:.0f} %); the median of U over the true error is {median:.1f}.

{scenes_table}

Missed:

{missed}
"""


def page(table):
    """Text of DOC/studies/uncertainty.md; '' where no scene has all its meshes."""
    found = judged(table)
    if not len(found):
        return ""

    def span(values):
        return f"{values.min():.2g} to {values.max():.2g}"
    by_scene = found.groupby("scene", sort=False).agg({
        "held": lambda held: f"{held.sum()} of {len(held)}", "U, %": span, "error, %": span, "judged by": lambda by: ", ".join(sorted(set(by)))})
    return PAGE.format(
        scenes=len(by_scene), held=found["held"].sum(), count=len(found), share=100.0 * found["held"].mean(), median=found["U/error"].median(),
        scenes_table=markdown_table(by_scene.reset_index()), missed=markdown_table(found[~found["held"]].drop(columns=["order", "held"])))


STUDY = Study("uncertainty", jobs, measure, chart, page=page)
