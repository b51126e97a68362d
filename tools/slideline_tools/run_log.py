# SPDX-License-Identifier: MIT
"""What the log of a run alone tells: penalties and laws as the program took them, limits of the
step, and where rigid walls stand. Results files hold none of these."""
from __future__ import annotations

import dataclasses
import re

NUMBER = r"([-+0-9.E]+)"
PAIR = rf"\({NUMBER}, {NUMBER}\)"
UNIT = r"(?: \S+(?: \S+)??)??"  # its name, where the deck tells its units (*CONTROL_UNITS)
PENALTIES = (rf"{NUMBER}{UNIT} per slave node = {NUMBER}[^;,]*(?:; master pass {NUMBER}{UNIT} "
             rf"per master node = {NUMBER})?")
SIDE = rf"(\d+) nodes, \d+ segments of mean length {NUMBER}"
#: lines of an interface and the attributes that their numbers are; indented ones belong to the last
OF_INTERFACE = (
    (rf"  slave: {SIDE}", ("n_slave", "slave_length")),
    (rf"  master: {SIDE}", ("n_master", "master_length")),
    (rf"interface (?P<id>\d+): penalty {PENALTIES}",
     ("node_penalty", "slave_penalty", "", "master_penalty")),
    (rf"  penalty: {PENALTIES}", ("node_penalty", "slave_penalty", "", "master_penalty")),
    (rf"  penalty: {NUMBER} of the largest stable one", ("stable_share",)),
    (rf"  friction: coefficient {NUMBER}(?: at rest, {NUMBER} in fast sliding, decay {NUMBER}"
     rf"{UNIT})?(?:, stress at most {NUMBER}[^;]*)?;",
     ("friction", "sliding_friction", "decay", "most_friction")),
    (rf"  damping: {NUMBER} of critical", ("damping",)),
    (rf"interface (?P<id>\d+): friction has dissipated {NUMBER}", ("dissipated",)),
)
#: words of a material that become names of its values
HARDENING = ((rf"hardening by (\d+) point\(s\) to plastic strain {NUMBER}, then modulus ",
              r"points of hardening \1, last plastic strain \2, last plastic modulus "),
             (rf"(\d+) strain rates from {NUMBER} to ",
              r"strain rates \1, lowest strain rate \2, highest strain rate "),
             (", P ", ", Cowper-Symonds P "))


@dataclasses.dataclass
class Part:
    """A part, with the data of its material and its elements."""

    id: int
    title: str
    n_element: int
    material: int
    points: int = 1
    viscosity: tuple[float, float] = (0.0, 0.0)


@dataclasses.dataclass
class Interface:
    """An interface in the units of the deck: penalties per unit length (`node_penalty` per node),
    of one pass no `master_penalty`; `stable_share` of the largest stable penalty (PUNIT 3)."""

    id: int
    name: str
    ctype: int
    n_slave: int = 0
    n_master: int = 0
    slave_length: float = 0.0
    master_length: float = 0.0
    node_penalty: float = 0.0
    slave_penalty: float = 0.0
    master_penalty: float = 0.0
    stable_share: float = 0.0
    damping: float = 0.0
    friction: float = 0.0          # coefficient at rest
    sliding_friction: float = 0.0  # in fast sliding
    decay: float = 0.0             # DC
    most_friction: float = 0.0     # VC, 0 = no cap
    dissipated: float | None = None  # by friction, at the end

    @property
    def label(self) -> str:
        """Words for a reader."""
        return f"interface {self.id} ({self.name}, type {self.ctype})"


@dataclasses.dataclass
class Wall:
    """A rigid wall: a point, its unit normal (towards the bodies), and how many nodes see it."""

    id: int
    point: tuple[float, float]
    normal: tuple[float, float]
    n_node: int | None = None


@dataclasses.dataclass
class RunLog:
    """Everything that is read from a log; `own_speeds` are materials whose wave speed the log
    gives for the start alone, `element_limit` the smallest L/c at time zero (0 = unknown)."""

    parts: dict[int, Part] = dataclasses.field(default_factory=dict)
    materials: dict[int, dict[str, float]] = dataclasses.field(default_factory=dict)
    own_speeds: list[int] = dataclasses.field(default_factory=list)
    interfaces: dict[int, Interface] = dataclasses.field(default_factory=dict)
    walls: dict[int, Wall] = dataclasses.field(default_factory=dict)
    capped: bool = False         # a curve caps the step
    element_limit: float = 0.0
    normal: bool = False         # ended normally
    is_implicit: bool = False    # it begins as an implicit run
    is_restart: bool = False     # of a restart alone, which does not describe the model again


def read_log(text: str) -> RunLog:
    """The log as data; what is not found keeps its default."""
    log = RunLog()
    for line in text.splitlines():
        if line.startswith("interface ") or line.startswith("  "):
            read_interface(log, line)
        elif line.startswith("part "):
            read_part(log, line)
        elif found := re.match(r"material (\d+): (.*)", line):
            log.materials[int(found[1])] = material_data(found[2])
            if "(K and c of the start)" in line:
                log.own_speeds.append(int(found[1]))
        elif found := re.match(rf"wall (\d+): through {PAIR}, normal {PAIR}, seen by (\d+)", line):
            x, y, along_x, along_y = map(float, found.groups()[1:5])
            log.walls[int(found[1])] = Wall(int(found[1]), (x, y), (along_x, along_y),
                                            int(found[6]))
        elif found := re.search(rf"smallest L/c of the elements {NUMBER}", line):
            log.element_limit = float(found[1])
        elif line.startswith("goes on from the restart file"):
            log.is_restart = log.element_limit == 0.0 and not log.is_implicit
        log.capped |= line.startswith("step capped by curve")
        log.normal |= "N o r m a l" in line
        log.is_implicit |= line.startswith("implicit method:")
    return log


def material_data(text: str) -> dict[str, float]:
    """name -> value of the line of a material."""
    for pattern, words in HARDENING:
        text = re.sub(pattern, words, text)
    return {name: float(value) for name, value
            in re.findall(rf"([A-Za-z][A-Za-z -]*?) {NUMBER}(?:, |$)", text)}


def read_part(log: RunLog, line: str) -> None:
    """The lines of a part."""
    if found := re.match(r'part (\d+) "(.*)": (\d+) elements, section \d+, material (\d+)', line):
        number = int(found[1])
        log.parts[number] = Part(number, found[2], int(found[3]), int(found[4]))
    elif found := re.match(rf"part (\d+): (.*), bulk viscosity Q1 {NUMBER} Q2 {NUMBER}", line):
        if part := log.parts.get(int(found[1])):
            part.points = 4 if found[2].startswith("fully") else 1
            part.viscosity = (float(found[3]), float(found[4]))


def read_interface(log: RunLog, line: str) -> None:
    """The lines of an interface."""
    if found := re.match(r'interface (\d+)(?: ".*")?: (.*) \(type (\d+)\)', line):
        log.interfaces[int(found[1])] = Interface(int(found[1]), found[2], int(found[3]))
        return
    for pattern, names in OF_INTERFACE:
        if not (found := re.match(pattern, line)):
            continue
        number = found.groupdict().get("id")
        last = next(reversed(log.interfaces.values()), None)
        one = log.interfaces.get(int(number)) if number else last
        if one is None:
            return
        values = found.groups()[1 if number else 0:]
        for name, value in zip(names, values):
            kind = int if name.startswith("n_") else float
            if name:
                setattr(one, name, kind(value or 0))
        if "friction" in names and values[1] is None:
            one.sliding_friction = one.friction
        return
