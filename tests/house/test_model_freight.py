# SPDX-License-Identifier: MIT
"""The first of several processes hands the model to the others: no component may be forgotten on the way."""
import itertools
import re

import pytest
from fortran_source import ROOT, read_source
from test_restart_components import types_of

#: what stands for a component on its way -> why it is not passed by `pass_model` under its own name
IN_PIECES = "goes in pieces, mesh_freight.f90"
ELSEWHERE = {
    "mesh_t": {"node_id": IN_PIECES, "coordinates": IN_PIECES, "element_id": IN_PIECES, "element_nodes": IN_PIECES,
               "element_part": IN_PIECES, "deck_node": "the order of results, which the first process writes"},
    "layout_t": {"slot_element": IN_PIECES, "slot_nodes": IN_PIECES, "slot_local": IN_PIECES, "element_slot": IN_PIECES},
    "conditions_t": {"initial_velocity": IN_PIECES, "fixed_nodes": "of its own nodes, rank_model.f90",
                     "fixed_directions": "of its own nodes, rank_model.f90"},
    "model_t": {"node_sets": "conditions and surfaces have been made of them", "segment_sets": "likewise",
                "part_sets": "likewise", "shell_sets": "likewise"},
    "controls_t": {"implicit": "runs of several processes are explicit, its default"},
}
#: the name that a type's variables have where they are passed, if not that of the type
NAMES = {"common_motion_t": "common", "output_plan_t": "plan", "boundary_rows_t": "rows", "force_group_t": "group",
         "cross_section_t": "section"}
WALK = ROOT / "src/model/model_freight.f90"
PIECES = ROOT / "src/model/mesh_freight.f90"


def declared():
    """type -> {component: its declaration}, of all types that a model may hold."""
    found = {}
    for path in (ROOT / "src/model").glob("*.f90"):
        kinds, inside = types_of(path), None
        for _, statement in read_source(path).statements:
            begins = re.match(r"type\s*(?:,[^:]*)?::\s*(\w+)$", statement, re.I)
            if begins:
                inside = begins.group(1).lower()
                found[inside] = {}
            elif re.match(r"end\s*type", statement, re.I):
                inside = None
            elif inside and "::" in statement:
                head, names = statement.split("::", 1)
                found[inside].update({name: (head, names) for name in kinds[inside]
                                      if re.search(rf"\b{name}\b", names, re.I)})
    return found


TYPES = declared()


def holds(kind):
    """The types of the components of a type that go along, those of the components of these, and so on."""
    seen, waiting = set(), [kind]
    while waiting:
        one = waiting.pop()
        if one in seen:
            continue
        seen.add(one)
        for name, (head, _) in TYPES[one].items():
            if name not in ELSEWHERE.get(one, {}):
                waiting += [kind.lower() for kind in re.findall(r"type\((\w+)\)", head)]
    return seen


def is_plain(kind):
    """Whether a type may be copied as it lies in memory."""
    return not any("allocatable" in head or "pointer" in head
                   for one in holds(kind) for head, _ in TYPES[one].values())


STATEMENTS = [statement for _, statement in read_source(WALK).statements]
PASSED = set(re.findall(r"(\w+(?:%\w+)+)", " ".join(s for s in STATEMENTS if re.search(r"\bcall pass", s))))


@pytest.mark.parametrize("kind", sorted(one for one in holds("model_t") if not is_plain(one)))
def test_every_component_goes_along(kind):
    before = NAMES.get(kind, kind[:-2])
    reasons = ELSEWHERE.get(kind, {})
    assert set(reasons) <= set(TYPES[kind])
    sent = {component for path in PASSED for one, component in itertools.pairwise(path.split("%")) if one == before}
    missing = set(TYPES[kind]) - set(reasons) - sent
    assert not missing, f"{kind}: not handed to other processes ({WALK.name}): {sorted(missing)}"
    assert not set(reasons) & sent, f"{kind}: passed after all: {sorted(set(reasons) & sent)}"


def test_what_goes_in_pieces_does():
    text = PIECES.read_text(encoding="utf-8")
    for kind, reasons in ELSEWHERE.items():
        for name in (name for name, why in reasons.items() if why == IN_PIECES):
            assert re.search(rf"call pass_\w+\([^)]*%{name}\(", text), f"{kind}: {name}"


def test_only_plain_types_are_copied_as_they_lie():
    """What `c_loc` is asked of has no allocatable components."""
    copied = re.findall(r"c_loc\(([\w%]+)", " ".join(STATEMENTS))
    assert len(copied) > 15
    for place in copied:
        names = place.split("%")
        owner = {NAMES.get(kind, kind[:-2]): kind for kind in TYPES}.get(names[-2]) if len(names) > 1 else None
        head = TYPES[owner][names[-1]][0] if owner else place
        kinds = [name.lower() for name in re.findall(r"type\((\w+)\)", head)]
        if not owner:
            kinds = [{"motions": "prescribed_motion_t", "loads": "nodal_load_t"}[names[0]]]
        assert all(is_plain(one) for one in kinds), place
