# SPDX-License-Identifier: MIT
"""What the log of a run says about its parts, materials, interfaces and steps."""
from __future__ import annotations

import dataclasses
import re

NUMBER = r"([-+0-9.E]+)"
UNIT = r"(?: \S+(?: \S+)??)??"  # its name, where the deck tells its units (*CONTROL_UNITS)
PENALTIES = (rf"{NUMBER}{UNIT} per slave node = {NUMBER}[^;,]*(?:; master pass {NUMBER}{UNIT} per master "
             rf"node = {NUMBER})?")


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
    """An interface; in the units of the deck; penalties per unit length (`node_penalty` per node), of one pass no `master_penalty`."""

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
    damping: float = 0.0
    is_automatic: bool = False   # penalty by the program from the step (PUNIT 3)
    friction: float = 0.0        # coefficient at rest
    sliding_friction: float = 0.0  # in fast sliding
    decay: float = 0.0           # DC
    most_friction: float = 0.0   # VC, 0 = no cap
    dissipated: float | None = None  # by friction, at the end
    estimate: str = ""           # of the error, at the end, in words
    missed: tuple[str, str] | None = None  # a target that was not kept, and what would keep it

    @property
    def label(self) -> str:
        """Words for a reader."""
        return f"interface {self.id} ({self.name}, type {self.ctype})"


@dataclasses.dataclass
class Wall:
    """A rigid wall: a point of it, its unit normal (towards the bodies), and how many nodes see it."""

    id: int
    point: tuple[float, float]
    normal: tuple[float, float]
    n_node: int | None = None


@dataclasses.dataclass
class RunLog:
    """Everything that is read from a log."""

    parts: dict[int, Part] = dataclasses.field(default_factory=dict)
    materials: dict[int, dict[str, float]] = dataclasses.field(default_factory=dict)
    own_speeds: list[int] = dataclasses.field(default_factory=list)  # materials whose wave speed is that of the start alone
    interfaces: dict[int, Interface] = dataclasses.field(default_factory=dict)
    walls: dict[int, Wall] = dataclasses.field(default_factory=dict)
    driven: bool = False         # loads or prescribed motion
    step_scale: float = 0.0      # TSSFAC
    capped: bool = False         # a curve caps the step
    element_limit: float = 0.0   # smallest L/c at time zero, 0 = unknown
    normal: bool = False         # ended normally
    is_implicit: bool = False    # it begins as an implicit run
    is_restart: bool = False     # the log of a restart alone, which does not describe the model again


def read_log(text: str) -> RunLog:
    """The log as data; what is not found keeps its default."""
    log = RunLog()
    for line in text.splitlines():
        read_part(log, line)
        read_interface(log, line)
        read_wall(log, line)
        if found := re.match(r"material (\d+): (.*)", line):
            log.materials[int(found[1])] = material_data(found[2])
            if "(K and c of the start)" in line:
                log.own_speeds.append(int(found[1]))
        elif found := re.match(r"conditions: \d+ fixed and (\d+) moved degrees of freedom, "
                               r"(\d+) nodal loads, (\d+) pressure edges, (\d+) body loads", line):
            log.driven = any(int(count) for count in found.groups())
        elif found := re.search(rf"step scale {NUMBER}", line):
            log.step_scale = float(found[1])
        elif line.startswith("step capped by curve"):
            log.capped = True
        elif found := re.search(rf"smallest L/c of the elements {NUMBER}", line):
            log.element_limit = float(found[1])
        elif "N o r m a l" in line:
            log.normal = True
        elif line.startswith("implicit method:"):
            log.is_implicit = True
        elif line.startswith("goes on from the restart file"):
            log.is_restart = log.element_limit == 0.0 and not log.is_implicit
    return log


def material_data(text: str) -> dict[str, float]:
    """name -> value of the line of a material; hardening by points and its strain rates in words of their own."""
    text = re.sub(rf"hardening by (\d+) point\(s\) to plastic strain {NUMBER}, then modulus ",
                  r"points of hardening \1, last plastic strain \2, last plastic modulus ", text)
    text = re.sub(rf"(\d+) strain rates from {NUMBER} to ",
                  r"strain rates \1, lowest strain rate \2, highest strain rate ", text)
    text = text.replace(", P ", ", Cowper-Symonds P ")
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


def read_wall(log: RunLog, line: str) -> None:
    """The line of a rigid wall."""
    pair = rf"\({NUMBER}, {NUMBER}\)"
    if found := re.match(rf"wall (\d+): through {pair}, normal {pair}, seen by (\d+) nodes", line):
        x, y, along_x, along_y = (float(number) for number in found.groups()[1:5])
        log.walls[int(found[1])] = Wall(int(found[1]), (x, y), (along_x, along_y), int(found[6]))


def read_interface(log: RunLog, line: str) -> None:
    """The lines of an interface; indented ones belong to the last."""
    if found := re.match(r'interface (\d+)(?: ".*")?: (.*) \(type (\d+)\)', line):
        number = int(found[1])
        log.interfaces[number] = Interface(number, found[2], int(found[3]))
        return
    if found := re.match(rf"interface (\d+): penalty {PENALTIES}", line):
        if interface := log.interfaces.get(int(found[1])):
            set_penalties(interface, found.groups()[1:])
    if found := re.match(rf"interface (\d+): friction has dissipated {NUMBER}", line):
        if interface := log.interfaces.get(int(found[1])):
            interface.dissipated = float(found[2])
    if found := re.match(r"interface (\d+): contact pressure and the stress behind it differ by (.*?)[,;] (?:by|springs)", line):
        if interface := log.interfaces.get(int(found[1])):
            interface.estimate = found[2]
    if found := re.match(r"interface (\d+): the target (.*) is not kept; (.*)", line):
        if interface := log.interfaces.get(int(found[1])):
            interface.missed = (found[2], found[3])
    if not line.startswith("  ") or not log.interfaces:
        return
    last = list(log.interfaces.values())[-1]
    if found := re.match(rf"  slave: (\d+) nodes, \d+ segments of mean length {NUMBER}", line):
        last.n_slave, last.slave_length = int(found[1]), float(found[2])
    elif found := re.match(rf"  master: (\d+) nodes, \d+ segments of mean length {NUMBER}", line):
        last.n_master, last.master_length = int(found[1]), float(found[2])
    elif found := re.match(rf"  penalty: {PENALTIES}", line):
        set_penalties(last, found.groups())
    elif found := re.match(rf"  friction: coefficient {NUMBER}(?: at rest, {NUMBER} in fast sliding, decay {NUMBER}{UNIT})?"
                           rf"(?:, stress at most {NUMBER}[^;]*)?;", line):
        last.friction, fast, last.decay, last.most_friction = (float(number or 0.0) for number in found.groups())
        last.sliding_friction = fast if found[2] else last.friction
    elif re.match(rf"  penalty: {NUMBER} of the largest stable one", line):
        last.is_automatic = True
    elif found := re.match(rf"  damping: {NUMBER} of critical", line):
        last.damping = float(found[1])


def set_penalties(interface: Interface, numbers: tuple[str, ...]) -> None:
    """The penalties of a line: per slave node, per length; of two passes per master node, per its length."""
    node, slave, _, master = (float(number or 0.0) for number in numbers)
    interface.node_penalty, interface.slave_penalty, interface.master_penalty = node, slave, master
