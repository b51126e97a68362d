# SPDX-License-Identifier: MIT
"""The claims of Kang, Lee & Shin (2023) about types 1, 3, 4, 5 and 6, answered from the table of the study.

A verdict is `yes` where all answers of a claim hold, `no` where none does, else `partly`. Contact times that differ by
less than `COST_FACTOR` count as alike, so that a repeat does not change an answer.
"""
import pandas as pd

from slideline_tools.studies.common import markdown_table
from slideline_tools.studies.framework.rules import COST_FACTOR, between, geometric_mean, least, share_verdict
from slideline_tools.studies.framework.table import finished

COMPARED = (1, 3, 4, 5, 6)
CLAIMS = ("NTS-mAR has the fewest force peaks", "... but larger ones", "the mortar history is the smoothest",
          "NTS-mAR is smoother than VTS-PPT",
          "NTS over- and two-pass NTS-AR underestimates the pressure at the end",
          "at most N - 1 master-to-slave points for N slave nodes", "step M is cheaper than A and B",
          "the collision's contact cost is mostly detection", "NTS-mAR is the cheapest remedy")


def claim_table(table, times):
    """Claim, answer and figures; '' unless all that is compared has run. `times`: see costs.times_of."""
    runs = finished(table[table["role"] == "result"])
    if not all(set(COMPARED) <= set(some) for some in (
            runs[runs["scene"] == "sliding"]["type"], runs[runs["scene"] == "block"]["type"],
            *(times.xs(scene)["ratio"].unstack(0).dropna().index if scene in times.index else ()
              for scene in ("sliding", "collision")))):
        return ""
    answers = [*peak_answers(runs[runs["scene"] == "sliding"]), end_answer(runs[runs["scene"] == "block"]),
               point_answer(runs), *time_answers(times)]
    return markdown_table(["claim", "answer", "figures"], [(claim, *answer) for claim, answer in zip(CLAIMS, answers)])


def held(answers):
    """'N_r 1, 3': the levels at which an answer is true."""
    levels = [str(level) for level, answer in answers.items() if answer]
    return "N_r " + ", ".join(levels) if levels else "no N_r"


def peak_answers(sliding):
    """Four claims about the force of the sliding."""
    count, largest, rms, wave = (sliding.pivot(index="level", columns="type", values=name)
                                 for name in ("peaks", "largest", "rms", "waviness"))
    every, nts = (count[5] < count[others].min(axis=1) for others in ([1, 3, 4, 6], [1, 3, 4]))
    larger = largest[5] > largest[[3, 4, 6]].max(axis=1)
    smooth = [figure[list(COMPARED)].idxmin(axis=1) == 6 for figure in (rms, wave)]
    calm, still = rms[5] < rms[4], wave[5] < wave[4]
    return [
        ("yes" if every.all() else share_verdict([*every, *nts]),
         f"fewer than types 1, 3, 4 and 6 at {held(every)}, than types 1, 3 and 4 at {held(nts)}"),
        (share_verdict(larger), f"larger than those of types 3, 4 and 6 at {held(larger)}"),
        (share_verdict([*smooth[0], *smooth[1]]),
         f"of types 1, 3 to 6 the smallest rms at {held(smooth[0])}, waviness at {held(smooth[1])}"),
        (share_verdict([*calm, *still]), f"smaller rms at {held(calm)}, waviness at {held(still)}")]


def end_answer(blocks):
    """Pressure of the end node of the slave over the one-dimensional one, explicit."""
    runs = blocks.set_index("type")
    over, under, shallow = runs["end_pressure"][1], runs["end_pressure"][3], runs["end_depth"][3]
    verdict = "yes" if over > 0.0 > under else "partly" if over > 0.0 or min(under, shallow) < 0.0 else "no"
    return verdict, (f"type 1 {100.0 * over:+.2f} %, type 3 {100.0 * under:+.2f} %, its penetration over the mean "
                     f"{100.0 * shallow:+.2f} %")


def point_answer(runs):
    """Points of type 5, the master coarser than the slave; `partly` where less than 5 % of the states have more."""
    counts, exchanged = (runs[(runs["scene"] == scene) & (runs["type"] == 5)] for scene in ("sliding", "exchanged"))
    above, states = int(counts["states_above"].sum()), int(counts["states"].sum())
    words = f"above it in {above} of {states} states, with at most {counts['nodes_above'].max():.0f} touching nodes"
    if not exchanged.empty:
        words += (f"; with the master finer in {exchanged['states_above'].sum():.0f} of {exchanged['states'].sum():.0f}")
    return "yes" if above == 0 else "partly" if above < 0.05 * states else "no", words


def time_answers(times):
    """Three claims about what contact costs in sliding and collision."""
    times = times.loc[["sliding", "collision"]]
    placing = times[times.index.isin([4, 5], level="type")]
    over = pd.DataFrame({step: placing["pairing"] / placing[step] for step in ("search", "force")})
    cheaper = over.max(axis=1) < 1.0
    search = (times["search"] / times["contact"]).loc["collision"]
    shares = {ctype: geometric_mean(search.xs(ctype, level="type")) for ctype in COMPARED}
    costs = {scene: {ctype: geometric_mean(times["ratio"].xs((scene, ctype), level=("scene", "type")))
                     for ctype in COMPARED[1:]} for scene in ("sliding", "collision")}
    rivals = {scene: min((ctype for ctype in row if ctype != 5), key=row.get) for scene, row in costs.items()}
    return [
        (share_verdict(cheaper), f"in {cheaper.sum()} of {len(cheaper)} runs; M over A {between(over['search'])}, "
         f"M over B {between(over['force'])}"),
        (share_verdict(share * COST_FACTOR > 0.5 for share in shares.values()),
         ", ".join(f"type {ctype} {100.0 * share:.0f} %" for ctype, share in shares.items())),
        (remedy_verdict([least(row, COST_FACTOR) for row in costs.values()]),
         ", ".join(f"{row[5] / row[rivals[scene]]:.2f} times type {rivals[scene]} in the {scene}"
                   for scene, row in costs.items()))]


def remedy_verdict(first):
    """Whether type 5 is the cheapest; `first`: the types of least cost, scene by scene."""
    if all(types == [5] for types in first):
        return "yes"
    return "partly" if any(5 in types for types in first) else "no"
