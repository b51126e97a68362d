# SPDX-License-Identifier: MIT
"""How fast steady sliding with friction flutters, over coefficient and penalty, beside what eigenvalues say; what damps it."""
from __future__ import annotations

from slideline_tools.studies.framework.charts import save, styled
from slideline_tools.studies.framework.job import Job, Study
from slideline_tools.studies.stability_friction.measures import measure_run
from slideline_tools.studies.stability_friction.page import draw_map, write_friction_page
from slideline_tools.studies.stability_friction.scene import Cure, deck, flutter, penalty

FRICTIONS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8)
RATIOS = (0.1, 0.3, 1.0, 3.0, 10.0)      # penalty over K L/A
QUICK_FRICTIONS, QUICK_RATIOS = (0.2, 0.5), (1.0,)
CURED_TYPES, CURED_FRICTION, CURED_RATIO = (5, 7), 0.5, 1.0
VDC = (5.0, 10.0, 20.0, 50.0)            # per cent of critical
MASS = (0.5, 0.9, 1.1, 1.5)              # D over twice the predicted rate
VISCOSITY = (0.06, 0.24)                 # Q2
VISCOUS_FORM = (0.05, 0.1)               # coefficient of viscous hourglass control
PATIENCE = 120.0                         # s for a run


def jobs(options):
    """Each type over coefficients and penalties; types 5 and 7 with each cure."""
    listed = [job(ctype, friction, ratio, "map") for ctype in options.types
              for friction in (QUICK_FRICTIONS if options.quick else FRICTIONS)
              for ratio in (QUICK_RATIOS if options.quick else RATIOS)]
    for ctype in CURED_TYPES:
        if ctype in options.types and not options.quick:
            listed += [job(ctype, CURED_FRICTION, CURED_RATIO, kind, amount, cure) for kind, amount, cure in cures(ctype)]
    return listed


def cures(ctype):
    """(kind, amount, Cure) of all that is tried."""
    step = flutter(ctype).step(penalty(CURED_RATIO))
    rate, _ = flutter(ctype).growth(CURED_FRICTION, penalty(CURED_RATIO), step)
    yield from (("vdc", amount, Cure(vdc=amount)) for amount in VDC)
    yield from (("mass", amount, Cure(mass=2.0 * rate * amount)) for amount in MASS)
    yield from (("viscosity", amount, Cure(viscosity=amount)) for amount in VISCOSITY)
    yield from (("hourglass", amount, Cure(form=1, coefficient=amount)) for amount in VISCOUS_FORM)


def job(ctype, friction, ratio, kind, amount=0.0, cure=Cure()):
    """One run with its prediction."""
    model, stiffness = flutter(ctype), penalty(ratio)
    step = model.step(stiffness)
    predicted, omega = model.growth(friction, stiffness, step, cure.mass)
    labels = {"kind": kind, "type": ctype, "friction": friction, "ratio": ratio, "amount": amount, "step": step,
              "mass": cure.mass, "predicted": predicted, "predicted_omega": omega}
    name = f"type_{ctype}_mu_{friction:g}_pen_{ratio:g}" + (f"_{kind}_{amount:g}" if kind != "map" else "")
    return Job(name, deck(ctype, friction, ratio, cure), "run", ("ncpu=1",), labels, limit=PATIENCE)


def measure(one, folder):
    """What grows, and how fast."""
    return measure_run(folder, one.jobid)


def chart(rows, folder):
    """The map."""
    if any("rate" in row for row in rows):
        with styled():
            save(draw_map(rows), folder, "flutter")


def page(rows, doc):
    """doc/studies/stability_friction.md and its picture."""
    write_friction_page(rows, doc)


STUDY = Study("stability-friction", jobs, measure, chart, page=page)
