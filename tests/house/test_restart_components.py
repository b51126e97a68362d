# SPDX-License-Identifier: MIT
"""A restart file holds every component of everything that changes: none may be forgotten."""
import re

import pytest

from fortran_source import ROOT, read_source

#: type -> (file that declares it, file that keeps it, what stands there before a component,
#: components that are not kept like that and why)
KEPT = {
    "state_t": ("state/state.f90", "output/restart_state.f90", "state%", {
        "contacts": "kept one by one", "rigids": "kept one by one", "walls": "kept one by one",
        "estimates": "kept one by one",
        "boundary_since": "of this run, where the file has no works",
        "outlines": "made of the deck and the status of elements"}),
    "relaxation_state_t": ("state/relaxation_state.f90", "output/restart_state.f90", "relaxation%", {}),
    "erosion_state_t": ("state/erosion_state.f90", "output/restart_state.f90", "erosion%", {}),
    "rigid_state_t": ("state/rigid_state.f90", "output/restart_state.f90", "rigid%", {}),
    "wall_state_t": ("state/wall_state.f90", "output/restart_state.f90", "wall%", {}),
    "block_state_t": ("state/block_state.f90", "output/restart_state.f90", "elements%", {
        "n_failed": "counted in each step", "volume_change": "found in each step",
        "mass_shares": "made of the deck and the status of elements"}),
    "contact_state_t": ("state/contact_state.f90", "output/restart_contact.f90", "contact%", {
        "scratch": "nothing in it lasts to the next step"}),
    "contact_estimate_t": ("state/contact_estimate.f90", "output/restart_state.f90", "estimate%", {}),
    "contact_watch_t": ("state/contact_watch.f90", "output/restart_contact.f90", "watch%", {
        "changes": "kept one by one"}),
    "contact_change_t": ("state/contact_watch.f90", "output/restart_contact.f90", "change%", {}),
    "energy_limit_t": ("state/energy_limit_state.f90", "output/restart_contact.f90", "limit%", {}),
    "interference_memory_t": ("state/interference_state.f90", "output/restart_contact.f90", "interference%", {}),
    "tie_memory_t": ("state/tie_state.f90", "output/restart_contact.f90", "ties%", {}),
    "friction_memory_t": ("state/friction_state.f90", "output/restart_contact.f90", "friction%", {}),
    "tracking_t": ("state/contact_state.f90", "output/restart_contact.f90", "tracking%", {
        "n_aside": "set by each update", "own_spots": "from the deck", "shallowest": "of the depths (measure_depths)",
        "deepest": "of segment_depth"}),
    "bucket_grid_t": ("state/contact_state.f90", "output/restart_contact.f90", "grid%", {}),
    "facing_t": ("state/facing_state.f90", "output/restart_contact.f90", "facing%", {
        "present": "made of the lists and the deck"}),
    "facing_side_t": ("state/facing_state.f90", "output/restart_contact.f90", "side%", {
        "depth": "of the initial mesh", "caught": "of the initial mesh", "reached": "of the initial mesh"}),
    "segment_memory_t": ("state/contact_state.f90", "output/restart_contact.f90", "segments%", {}),
    "contact_points_t": ("state/contact_state.f90", "output/restart_contact.f90", "points%", {}),
    "step_plan_t": ("solve/explicit/time_step.f90", "solve/explicit/explicit_memory.f90", "steps%", {}),
    "spring_bound_t": ("contact/contact_step_limit.f90", "solve/explicit/explicit_memory.f90", "springs(i)%", {}),
    "schedule_t": ("output/output_schedule.f90", "output/restart_history.f90", "kept%", {
        "end_time": "from the deck, which may change it", "curve": "kept as two arrays"}),
    "histories_t": ("output/history_file.f90", "output/restart_history.f90", "histories%", {
        "tables": "kept one by one"}),
    "monitor_t": ("run/monitor.f90", "run/restart_run.f90", "monitor%", {
        "results": "times of its states are kept", "snapshot": "filled anew before it is written", "rows": "of the mesh", "bodies": "of the mesh",
        "log": "of each run", "told_radii": "of its log", "told_ratio": "of its log", "clock": "of each run", "progress": "of each run",
        "restarts": "n_dump is kept", "has_plot": "from the deck", "only_checks": "of a check",
        "ranks": "of each run", "tables": "kept one by one", "scheduled": "from the deck"}),
    "explicit_cycle_t": ("solve/explicit/explicit_cycle.f90", "solve/explicit/explicit_memory.f90", "", {
        "writes": "set in each cycle", "finished": "not when a file is written",
        "last": "found again", "plots": "of the run that was asked", "due": "set in each cycle",
        "leap": "made in each cycle", "sums": "formed in each cycle", "rest": "found anew in the first cycles", "refines": "from the deck", "presses": "from the deck", "pressing": "formed anew in each cycle", "common": "made in each cycle", "rates": "asked anew in the first cycle",
        "checks": "filled in each cycle", "failures": "of each log, counted anew", "steps": "kept as step_plan_t",
        "shares": "of each run", "borders": "of each run", "first_check": "of each run", "parcel": "filled in each cycle", "echoes": "of a second", "asked": "heard in each cycle",
        "told": "of the state", "freed": "not when a file is written",
        "timed_motions": "from the deck", "active": "asked anew in the first cycle", "velocity": "made in each cycle",
        "displacement": "made in each cycle", "reason": "of each run", "error": "of each run"}),
    "implicit_memory_t": ("solve/implicit/implicit_memory.f90", "solve/implicit/implicit_memory.f90", "", {
        "control": "kept as step_control_t", "step": "kept as step_t", "trial": "kept as trial_t",
        "written": "of another state"}),
    "step_control_t": ("solve/implicit/step_control.f90", "solve/implicit/implicit_memory.f90", "control%", {
        "next": "planned anew", "is_last": "planned anew", "end_time": "from the deck, which may change it",
        "is_automatic": "from the deck", "least": "from the deck", "most": "from the deck", "few": "from the deck",
        "many": "from the deck", "changes": "from the deck"}),
    "step_t": ("solve/implicit/implicit_tangent.f90", "solve/implicit/implicit_memory.f90", "step%", {
        "time": "set in each step", "dt": "set in each step", "is_dynamic": "from the deck",
        "alpha_m": "from the deck", "alpha_f": "from the deck", "gamma": "from the deck", "beta": "from the deck",
        "old_force": "formed from those of trial_t", "equations": "numbered in each step", "slips_on": "set in each step",
        "prescribed": "found in each step"}),
    "trial_t": ("solve/implicit/implicit_forces.f90", "solve/implicit/implicit_memory.f90", "trial%", {
        "motion": "of the step that is over", "elements": "those of the state", "contacts": "those of the state",
        "slots": "formed with each force", "before": "used up before a file is written"}),
}
#: types of src/state that hold no memory
WITHOUT_MEMORY = {"contact_scratch_t", "piece_table_t", "snapshot_t", "interface_result_t", "part_result_t", "slave_result_t",
                  "wall_result_t", "rubbed_t", "element_result_t", "body_result_t", "section_result_t",
                  "energies_t", "others_t", "answers_t"}


def types_of(path):
    """type -> its components, of one file"""
    found, inside = {}, None
    for _, statement in read_source(path).statements:
        begins = re.match(r"type\s*(?:,[^:]*)?::\s*(\w+)$", statement, re.I)
        if begins:
            inside = found.setdefault(begins.group(1).lower(), [])
        elif re.match(r"end\s*type", statement, re.I):
            inside = None
        elif inside is not None and "::" in statement:
            names = re.sub(r"\([^()]*(?:\([^()]*\)[^()]*)*\)", "", statement.split("::", 1)[1])
            inside += [name.split("=")[0].strip().lower() for name in names.split(",")]
    return found


def kept_names(path, before):
    """The components that the `keep...` calls of a file hand over under their own names."""
    text = " ".join(statement for _, statement in read_source(path).statements)
    pairs = re.findall(r"call keep\w*\(archive, '(\w+)', (?:time, dt, |n_node, )?([^,]+?)(?:, is_new|, others)?\)(?= |$)", text)
    return {name for name, handed in pairs if handed == before + name}


@pytest.mark.parametrize("kind", KEPT)
def test_every_component_is_kept(kind):
    declared, keeper, before, exempt = KEPT[kind]
    components = types_of(ROOT / "src" / declared)[kind]
    assert len(components) > 0 and set(exempt) <= set(components)
    missing = set(components) - set(exempt) - kept_names(ROOT / "src" / keeper, before)
    assert not missing, f"{kind}: not in the restart file (src/{keeper}): {sorted(missing)}"


def test_every_type_of_the_state_is_looked_at():
    types = {name for path in (ROOT / "src/state").glob("*.f90") for name in types_of(path)}
    assert types - WITHOUT_MEMORY <= set(KEPT)


#: driver -> (procedure with the loop over cycles or steps, what lives there and need not be kept, and why)
DRIVERS = {
    "solve/explicit/explicit.f90": ("advance_explicit", {"cycle": "kept as explicit_cycle_t"}),
    "solve/implicit/implicit.f90": ("advance_implicit", {
        "memory": "kept as implicit_memory_t", "asked": "of the present step", "second": "of the end of a run that fails",
        "last": "found again"}),
}


@pytest.mark.parametrize("path", DRIVERS)
def test_a_driver_remembers_nothing_else(path):
    """What lives across cycles or steps lies in the types above: a new variable beside the loop must be explained."""
    name, explained = DRIVERS[path]
    source = read_source(ROOT / "src" / path)
    loop, = [one for one in source.procedures if one.name == name]
    found = set()
    for line, statement in source.statements:
        if loop.first < line < loop.last and "::" in statement and "intent" not in statement:
            found |= {entry.split("=")[0].split("(")[0].strip() for entry in statement.split("::", 1)[1].split(",")}
    assert found == set(explained)


def test_a_name_is_kept_once_in_each_procedure():
    for path in {keeper for _, keeper, _, _ in KEPT.values()}:
        source = read_source(ROOT / "src" / path)
        for procedure in source.procedures:
            names = [name for line, statement in source.statements
                     if procedure.first <= line <= procedure.last
                     for name in re.findall(r"call keep\w*\(archive, '(\w+)'", statement)]
            assert len(names) == len(set(names)), f"{path}: {procedure.name}"
