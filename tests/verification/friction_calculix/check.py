# SPDX-License-Identifier: MIT
"""Beside CalculiX in the same run, static: a block sheared on a block, and a cylinder in partial slip."""
import os
import re
import shutil
import subprocess

import numpy as np

from contact_types import TYPES
from scenes import FRICTION, block_on_block, calculix_deck, cylinder_on_block, slideline_deck

KINDS = (2, 5, 7)
#: Place of s_xy among the stored stresses (xx, yy, zz, xy).
SHEAR = 3
#: Name, scene, ways looked at, the way at whose end all of the surface slips, and the scale of what forces may differ by; in full and else.
SCENES = {True: (("block on block", block_on_block, {2: "sticks and slips", 5: "slides", 7: "on the way back"}, 5),
                 ("cylinder on block", cylinder_on_block, {1: "Q 0.25 mu P", 2: "0.5", 3: "0.7", 4: "back to 0.2"}, None)),
          False: (("block on block", block_on_block, {1: "sticks and slips", 2: "slides", 3: "on the way back"}, 2),
                  ("cylinder on block", cylinder_on_block, {1: "Q 0.5 mu P", 2: "0.7", 3: "back to 0.2"}, None))}


class Answer:
    """At the end of each way: normal and shear force, and the mean stresses s_yy and s_xy of the slave's elements at the surface.

    Tractions of nodes are no common ground: CalculiX extrapolates those of the points of a face, ours are means about a node."""

    def __init__(self, normal, shear, pressed, sheared):
        self.normal, self.shear, self.pressed, self.sheared = (np.array(values) for values in (normal, shear, pressed, sheared))


def ours(run, scene, kind):
    """(Answer, largest |T| - mu p of a slave node over the largest mu p)."""
    result = run.program(slideline_deck(scene, kind)[0])
    rows, force = result.table("contact"), result.table("rcforc").where(side="slave")
    at = [np.argmin(np.abs(force["time"] - time)) for time in scene.times]
    stress = result.cells("stress")[[np.argmin(np.abs(result.times - time)) for time in scene.times]][:, scene.row]
    limit = FRICTION * rows["pressure"]
    beyond = np.max(np.abs(rows["traction"]) - limit) / np.max(limit)
    return Answer(np.abs(force["fy"][at]), -force["fx"][at], stress[..., 1], stress[..., SHEAR]), beyond


def theirs(run, scene, name):
    """Runs ccx and reads its .dat."""
    folder = run.work / "calculix"
    folder.mkdir(exist_ok=True)
    job = name.replace(" ", "_")
    (folder / f"{job}.inp").write_text(calculix_deck(scene), encoding="ascii")
    done = subprocess.run(["ccx", job], cwd=folder, capture_output=True, text=True, check=False, timeout=600,
                          env={**os.environ, "OMP_NUM_THREADS": "1"})
    (folder / f"{job}.log").write_text(done.stdout)
    if done.returncode:
        raise RuntimeError(f"ccx: status {done.returncode}, see {folder / job}.log")
    text = (folder / f"{job}.dat").read_text(encoding="ascii")
    totals = np.array([line.split()[:2] for line in re.findall(r"total force[^\n]*\n\s*\n([^\n]+)", text)], dtype=float)
    means = np.array([element_means(block, scene.slave_elements) for block in re.split(r"stresses \(elem[^\n]*\n", text)[1:]])
    return Answer(np.abs(totals[:, 1]), totals[:, 0], means[..., 0], means[..., 1])


def element_means(block, elements):
    """s_yy and s_xy, means over the points of each element."""
    points = {}
    for words in map(str.split, block.splitlines()):
        if len(words) == 8:
            points.setdefault(int(words[0]), []).append((float(words[3]), float(words[5])))
    return [np.mean(points[element], axis=0) for element in elements.tolist()]


def compare(run, name, mine, other, looks):
    """Forces over the largest; stresses in L2 over those of pressing and of full slip, at the ways in `looks`."""
    run.check(f"{name}: normal force", mine.normal, other.normal)
    run.check(f"{name}: shear force over the way", mine.shear, other.shear)
    for k, words in looks.items():
        pressing = np.linalg.norm(other.pressed[k])
        run.check(f"{name}, {words}: s_yy at the surface, L2", np.linalg.norm(mine.pressed[k] - other.pressed[k]) / pressing, 0.0)
        run.check(f"{name}, {words}: s_xy at the surface / mu s_yy, L2",
                  np.linalg.norm(mine.sheared[k] - other.sheared[k]) / (FRICTION * pressing), 0.0)


def check(run):
    has_peer = shutil.which("ccx") is not None
    if not has_peer:
        run.leave_out("ccx is missing, nothing was compared: apt-get install calculix-ccx")
    for name, make, looks, sliding in SCENES[run.is_full]:
        scene = make(run.is_full)
        other = theirs(run, scene, name) if has_peer else None
        for kind in KINDS:
            own = f"{name}, {TYPES[kind]}"
            mine, beyond = ours(run, scene, kind)
            run.check(f"{own}: |T| - mu p of a node / largest mu p", beyond, 0.0)
            if sliding is not None:
                # The face tilts as the block is sheared (strains of 1e-5): forces are not quite those along and across it.
                run.check(f"{own}: shear force / mu N, sliding", mine.shear[sliding] / (FRICTION * mine.normal[sliding]), 1.0)
            if has_peer:
                compare(run, own, mine, other, looks)
