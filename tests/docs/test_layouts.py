# SPDX-License-Identifier: MIT
"""Examples of materials, erosion and quasi-static help, written in every layout of fields, give the same bytes."""
import subprocess

import pytest

import examples

NAMES = ("mat_johnson_cook", "mat_simplified_johnson_cook", "mat_elastic_plastic_hydro", "mat_null", "mat_mooney-rivlin_rubber",
         "mat_blatz-ko_rubber", "mat_crushable_foam", "mat_add_erosion", "control_timestep_mass_scaling", "control_dynamic_relaxation",
         "control_bulk_viscosity", "damping_part_mass", "damping_part_stiffness", "load_rigid_body", "element_mass",
         "constrained_node_set", "define_coordinate_system", "hourglass_assumed_strain", "plate_impact_spall")
#: Option of *KEYWORD, mark behind each other keyword, least width of a field; None: commas.
LAYOUTS = {"LONG=Y": (" LONG=Y", "", 20), "+": ("", " +", 20), "I10=Y": (" I10=Y", "", 10), "commas": ("", "", None)}


def ends_of(header):
    """Where the fields of a card end, by the names above them, which stand flush right: '$#     mid        ro'; a list goes on."""
    ends = [k + 1 for k in range(2, len(header)) if header[k] != " " and header[k + 1:k + 2] in ("", " ")]
    return ends + (list(range(ends[-1] + 10, 90, 10)) if ends[-1] % 10 == 0 else [])


def written(text, layout):
    """The deck with each line of fields in another layout; titles stay."""
    option, mark, width = LAYOUTS[layout]
    lines, ends = [], None
    for line in text.splitlines():
        if line.startswith("*"):
            ends = None
            lines.append(line + (option if line == "*KEYWORD" else mark if line != "*END" else ""))
        elif line.startswith("$"):
            ends = ends_of(line) if line.startswith("$#") else ends
            lines.append(line)
        elif ends is None:
            # A title, or a card as of the keyword before.
            known = all(part.lstrip("-").replace(".", "").replace("E", "").replace("-", "").isdigit() for part in line.split())
            lines.append(spread(line, list(range(10, 90, 10)), width) if known else line)
        else:
            lines.append(spread(line, ends, width))
    return "\n".join(lines) + "\n"


def spread(line, ends, width):
    """The fields of a line of the standard layout that end at `ends`, wider or with commas."""
    fields = [(line[start:end].strip(), end - start) for start, end in zip([0, *ends], ends) if start < len(line)]
    if width is None:
        return ",".join(field for field, _ in fields) + ("," if len(fields) == 1 else "")
    return "".join(f"{field:>{max(width, room)}}" for field, room in fields)


def results(exe, folder, name, text):
    """All tables of a run."""
    (folder / f"{name}.k").write_text(text, encoding="utf-8")
    words = examples.read_example(examples.FOLDER / f"{name}.k").words
    done = subprocess.run([exe, f"i={name}.k", f"d={name}", *words], cwd=folder, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    return {path.name: path.read_bytes() for path in (folder / name).glob("*.csv") if not path.name.endswith("timing.csv")}


def test_ends_are_those_of_the_fields():
    assert ends_of("$#   nid               x               y") [:3] == [8, 24, 40]
    assert spread("       1             0.5", [8, 24], 20) == f"{1:20d}{0.5:20}"
    assert spread("         1", [10], None) == "1,"


@pytest.mark.parametrize("name", NAMES)
def test_layouts(name, exe, tmp_path):
    text = (examples.FOLDER / f"{name}.k").read_text(encoding="utf-8")
    (tmp_path / "parts").symlink_to(examples.FOLDER / "parts")
    wanted = results(exe, tmp_path, name, text)
    assert wanted
    for layout in LAYOUTS:
        changed = written(text, layout)
        assert changed != text
        assert results(exe, tmp_path, name, changed) == wanted, layout
