# SPDX-License-Identifier: MIT
"""Each type names its components in its `visit`: for restart files, other processes and memory none may be forgotten."""
import re

import pytest

from fortran_source import ROOT, read_source

OF_THE_DECK = "from the deck"
EACH_CYCLE = "made, asked or found anew in each cycle"
#: type -> {component: why its `visit` does not name it}
EXEMPT = {
    "state_t": {"boundary_since": "of this run, where the file has no works",
                "interfaces": "made of the deck and the status of elements"},
    "block_state_t": {"mass_shares": "made of the deck and the status of elements"},
    "contact_state_t": {"has": OF_THE_DECK, "scratch": "nothing in it lasts to the next step",
                        "candidates": "no result depends on them", "reversed": "no result depends on them",
                        "arcs": "those of the initial mesh"},
    "contact_status_t": {"due": EACH_CYCLE, "faded": EACH_CYCLE, "pass": OF_THE_DECK, "reach": OF_THE_DECK},
    "segment_status_t": {"has_points": EACH_CYCLE},
    "schedule_t": {"end_time": "from the deck, which may change it", "curve": "kept as two arrays"},
    "histories_t": {"tables": "rows one table after another"},
    "explicit_cycle_t": dict.fromkeys((
        "writes", "finished", "last", "due", "leap", "sums", "tile_states", "pressure_steps", "common", "rates", "checks", "halo",
        "asked", "active", "velocity", "displacement", "freed"), EACH_CYCLE) | dict.fromkeys((
            "plots", "partition", "first_check", "recent", "failures", "reason", "error"), "of each run") | dict.fromkeys((
                "refines", "has_pressures", "timed_motions"), OF_THE_DECK) | {"n_eroded_seen": "of the state"},
    "implicit_memory_t": {"written": "of another state"},
    "step_control_t": {"next": "planned anew", "is_last": "planned anew", "end_time": "from the deck, which may change it"}
    | dict.fromkeys(("is_automatic", "least", "most", "few", "many", "changes"), OF_THE_DECK),
    "step_t": dict.fromkeys(("is_dynamic", "alpha_m", "alpha_f", "gamma", "beta"), OF_THE_DECK) | dict.fromkeys(
        ("time", "dt", "equations", "starts_slipping", "prescribed"), "set in each step") | dict.fromkeys(
            ("old_force", "old_bodies"), "formed from those of trial_t"),
    "trial_t": {"motion": "of the step that is over", "bodies": "of the step that is over",
                "elements": "those of the state", "contacts": "those of the state",
                "slots": "formed with each force", "before": "used up before a file is written"},
    "mesh_t": {"deck_node": "the order of results, which the first process writes"},
    "model_t": dict.fromkeys(("node_sets", "segment_sets", "part_sets", "shell_sets"), "conditions and surfaces have been made of them")
    | {"springback": "the first process writes the file of the next stage"},
    "controls_t": {"implicit": "runs of several processes are explicit, its default"},
}
#: types of src/state that hold no memory
WITHOUT_MEMORY = {"arc_shape_t", "arcs_t", "contact_scratch_t", "features_t", "candidates_t", "pass_t", "spring_t", "snapshot_t",
                  "interface_result_t", "part_result_t", "slave_result_t",
                  "wall_result_t", "friction_result_t", "element_result_t", "body_result_t", "section_result_t",
                  "energies_t", "remote_t", "inside_tests_t"}


def types_of(path):
    """type -> {component: its declaration}, of one file."""
    found, inside = {}, None
    for _, statement in read_source(path).statements:
        begins = re.match(r"type\s*(?:,[^:]*)?::\s*(\w+)$", statement, re.I)
        if begins:
            inside = found.setdefault(begins.group(1).lower(), {})
        elif re.match(r"end\s*type|contains", statement, re.I):
            inside = None
        elif inside is not None and "::" in statement:
            head, names = statement.split("::", 1)
            names = re.sub(r"\([^()]*(?:\([^()]*\)[^()]*)*\)|\[[^]]*\]", "", names)
            inside |= {name.split("=")[0].strip().lower(): head for name in names.split(",")}
    return found


def visits():
    """type -> (file, statements of its `visit`), of all types that have one."""
    found = {}
    for path in sorted((ROOT / "src").glob("**/*.f90")):
        source = read_source(path)
        kind = None
        for _, statement in source.statements:
            begins = re.match(r"type\s*,.*extends\(visited_t\).*::\s*(\w+)$", statement)
            kind = begins.group(1).lower() if begins else kind
            bound = re.match(r"procedure :: visit => (\w+)$", statement)
            if kind and bound:
                procedure, = [one for one in source.procedures if one.name == bound.group(1)]
                found[kind] = (path, [text for line, text in source.statements if procedure.first < line < procedure.last])
                kind = None
    return found


VISITS = visits()
TYPES = {kind: parts for path in sorted((ROOT / "src").glob("**/*.f90")) for kind, parts in types_of(path).items()}


def handed(statement):
    """(name given, component) pairs of a statement that hands components to the visitor."""
    pairs = re.findall(r"'(\w+)', (?:merge\(1, 0, )?self%(\w+)\b(?!%)", statement)
    plain = re.findall(r"plain\(c_loc\(self%(\w+)", statement)
    return [] if "%expect(" in statement else pairs + [(name, name) for name in plain]


@pytest.mark.parametrize("kind", VISITS)
def test_every_component_is_visited_once(kind):
    path, statements = VISITS[kind]
    components, exempt = types_of(path)[kind], EXEMPT.get(kind, {})
    assert len(components) > 0 and set(exempt) <= set(components)
    pairs = [pair for statement in statements for pair in handed(statement)]
    if kind == "cross_section_t":
        pairs.append(("is_corner", "is_corner"))  # as numbers
    assert all(name == component for name, component in pairs), pairs
    names = [name for name, _ in pairs]
    missing = set(components) - set(exempt) - set(names)
    assert not missing, f"{kind}: its visit does not name {sorted(missing)}"
    assert not set(exempt) & set(names) and len(names) == len(set(names)), sorted(names)


def test_exemptions_are_of_types_that_are_visited():
    assert set(EXEMPT) <= set(VISITS)


def test_every_type_of_the_state_is_visited():
    types = {name for path in (ROOT / "src/state").glob("*.f90") for name in types_of(path)}
    assert types - WITHOUT_MEMORY <= set(VISITS)


def holds(kind):
    """The types of the components that the visit of a type hands over, those of the components of these, and so on."""
    seen, waiting = set(), [kind]
    while waiting:
        one = waiting.pop()
        if one not in seen:
            seen.add(one)
            waiting += [inner.lower() for name, head in TYPES[one].items() if name not in EXEMPT.get(one, {})
                        for inner in re.findall(r"type\((\w+)\)", head)]
    return seen


@pytest.mark.parametrize("kind", sorted(holds("model_t") | {"step_plan_t", "explicit_cycle_t"}))
def test_what_is_not_visited_may_be_copied_as_it_lies(kind):
    """Types of a model without a visit have no allocatable components; `plain` is asked for these alone."""
    if kind in VISITS:
        plain = re.findall(r"plain\(c_loc\(self%(\w+)", " ".join(VISITS[kind][1]))
        inner = {one for name in plain for one in re.findall(r"type\((\w+)\)", TYPES[kind][name])}
        assert not any("allocatable" in head or "pointer" in head
                       for one in inner for part in holds(one) for head in TYPES[part].values()), inner
    else:
        assert not any("allocatable" in head for head in TYPES[kind].values())


#: driver -> (procedure with the loop over cycles or steps, what lives there and need not be kept, and why)
DRIVERS = {
    "solve/explicit/explicit.f90": ("advance_explicit", {"cycle": "visited as explicit_cycle_t"}),
    "solve/implicit/implicit.f90": ("advance_implicit", {
        "memory": "visited as implicit_memory_t", "asked": "of the present step", "second": "of the end of a run that fails",
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


#: what a restart file holds besides -> {component of `monitor_t` that it does not hold: why}
MONITOR = {"results": "times of its states are kept", "snapshot": "filled anew before it is written", "rows": "of the mesh",
           "bodies": "of the mesh", "restarts": "n_dump is kept", "has_plot": OF_THE_DECK, "scheduled": OF_THE_DECK,
           "only_checks": "of a check"} | dict.fromkeys(
               ("log", "warned_radii", "warned_ratio", "clock", "progress", "ranks"), "of each run")


def test_outputs_of_a_run_are_kept():
    text = (ROOT / "src/run/restart.f90").read_text(encoding="utf-8")
    kept = {name for name in TYPES["monitor_t"]
            if re.search(rf"call (?:visit_kept_schedule|archive%part)\([^\n]*monitor%{name}\b", text)}
    assert kept == set(TYPES["monitor_t"]) - set(MONITOR)
