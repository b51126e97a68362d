# SPDX-License-Identifier: MIT
"""The commands that show a run or a model: info, plot, animate, revolve, report and draw."""
import argparse
import pathlib

from slideline_tools.commands import ANY_FILE, FILE, PROGRAM, RUN, ZOOM, add, output_to

RESULTS = ("results", {"help": "<job>.vtkhdf, or the folder of one run"})
OF_FIELD = (
    RESULTS, ("--field", {"help": "for example plastic_strain, mises, velocity:y, stress:xy"}),
    ("--scale", {"type": float, "default": 1.0, "help": "factor on the displacements (1)"}), ZOOM,
    ("--mirror", {"action": "store_true",
                  "help": "with the image in x = 0: axisymmetric and half models as a whole"}))
FIELDS = """Fields: displacement, velocity, contact_force (with :x or :y, else the length),
contact_pressure, gap, contact_traction, contact_slip, contact_state (with friction), stress:xx (yy,
zz, xy), plastic_strain, pressure, mises. `info` lists those of a file."""
# The names of draw.picture.WHAT, here without its slow imports.
WHAT = ("mesh", "sets", "surfaces", "boundary", "motion", "velocity", "loads", "walls", "history")
ARROWS = """Slave surfaces are red, master surfaces blue, with arrow heads in their walking
direction (the body lies on the left) and short lines along the outward normals. Arrows of
velocities, motions and loads have the length of the largest value over time, within each kind."""


def add_all(commands) -> None:
    """Add these commands."""
    add(commands, info, "info", "say what a results file holds",
        f"info {FILE}", RESULTS)
    add(commands, plot, "plot",
        "draw a field, histories, the contact pressure or zones of stick and slip", f"""\
plot {FILE} -o x.png
plot {FILE} --field stress:xy --state 0.0007 --scale 5 -o x.png
plot {FILE} --field mises --state 10 --state -1 -o x.pdf
plot {FILE} --history glstat:kinetic,internal \\
      --history rcforc:fy@side=slave -o x.svg
plot {FILE} --contact --state 28 --state 30 -o x.png
plot {FILE} --zones --state 20 --state -1 -o x.png

{FIELDS}""", *OF_FIELD,
        ("--state", {"action": "append",
                     "help": "number (-1 = last, 0 = first) or time; may be repeated"}),
        ("--history", {"action": "append", "metavar": "TABLE:COLUMN,...[@NAME=VALUE]",
                       "help": "for example glstat:kinetic,internal or rcforc:fy@side=slave; may "
                               "be repeated"}),
        ("--contact", {"action": "store_true", "help": "contact pressure along the slave surface"}),
        ("--zones", {"action": "store_true",
                     "help": "with friction: where the slave surface sticks and slips over time, "
                             "and its traction beside mu p at the states"}),
        output_to("picture (.png, .pdf, .svg)", required=True))
    add(commands, animate, "animate", "moving picture of a field (GIF or MP4)",
        f"animate {FILE} --field mises --rate 24 -o x.gif", *OF_FIELD,
        ("--rate", {"type": float, "default": 12.0, "help": "pictures a second (12)"}),
        output_to("file ending in .gif or .mp4", required=True))
    add(commands, revolve, "revolve", "turn an axisymmetric run about its axis into solids", f"""\
revolve {RUN.replace('collision', 'taylor')} -o taylor_3d.vtkhdf
revolve {RUN.replace('collision', 'taylor')} --field mises --state -1 --degrees 180 -o x.png""", RESULTS,
        ("--degrees", {"type": float, "default": 270.0, "help": "angle, at most 360 (270)"}),
        ("--sectors", {"type": int, "default": 36, "help": "solids around (36)"}),
        ("--field", {"help": "field that colours the picture"}),
        ("--state", {"default": "-1", "help": "state of the picture: number or time (-1, the last)"}),
        output_to("file ending in .vtkhdf or .png", required=True))
    add(commands, report, "report", "write an HTML report of a run", f"""\
report {RUN}
report {RUN} --field mises --field stress:xy --state 0.0003 --state -1 -o r.html

A batch: for run in results/*/; do slideline-tools report "$run"; done""",
        ("run_path", {"metavar": "RUN", "help": ANY_FILE}),
        output_to("HTML file to write (default: <job>.report.html beside the results)"),
        ("--field", {"action": "append", "default": [],
                     "help": "field to show, for example mises, stress:xy, velocity:y; may be "
                             "repeated (default: plastic strain if any, and mises)"}),
        ("--state", {"action": "append", "default": [],
                     "help": "state to show: number (-1 = last, 0 = first) or time; may be "
                             "repeated (default: at the largest contact force, and the last)"}),
        ("--scale", {"type": float, "default": 1.0,
                     "help": "factor on the displacements in the pictures (1)"}), PROGRAM)
    add(commands, draw, "draw", "picture of a model before its run", f"""\
draw deck.k
draw deck.k p:v0=-40.0 --show mesh,surfaces --zoom 0 0.02 -0.002 0.002 -o gap.png
draw results/collision -o collision.png

{ARROWS}""",
        ("deck", {"metavar": "DECK",
                  "help": "keyword deck; or a results folder, whose deck as run is drawn"}),
        ("overrides", {"nargs": "*", "metavar": "OVERRIDE",
                       "help": "as for the program, for example p:ctype=5"}),
        output_to("picture (.png, .pdf, .svg; default: <deck>.png in this folder)"),
        ("--show", {"metavar": "WHAT,...", "type": wanted,
                    "help": f"only these of: {', '.join(WHAT)} (default: all)"}), ZOOM, PROGRAM)


def info(options) -> int:
    """Print what a results file holds."""
    from slideline_tools.describe import describe
    from slideline_tools.results import read
    print("\n".join(describe(read(options.results))))
    return 0


def plot(options) -> int:
    """Draw a picture of a results file. Without --field, --state, --history, --contact or --zones: a field above the energies
    and the contact force."""
    import slideline_tools
    slideline_tools.plot(options.results, options.field, *options.state or (), scale=options.scale,
                         zoom=options.zoom, history=options.history or (), contact=options.contact,
                         zones=options.zones, mirror=options.mirror, output=options.output)
    print(f"wrote {options.output}")
    return 0


def animate(options) -> int:
    """Write a moving picture of all states."""
    from slideline_tools import animation
    from slideline_tools.files import output
    from slideline_tools.mirrored import Mirrored
    from slideline_tools.results import read
    results = read(options.results)
    path = output(options.output, [results.path])
    count = animation.animate(Mirrored(results) if options.mirror else results, path, options.field,
                              options.scale, options.rate, options.zoom)
    print(f"wrote {options.output} ({count} states)")
    return 0


def revolve(options) -> int:
    """Turn the states of an axisymmetric run about the axis x = 0: a file of solids for ParaView with all states and fields
    (.vtkhdf), or a picture of one state (.png, takes VTK)."""
    from slideline_tools import UserError
    from slideline_tools import revolve as solids
    from slideline_tools.results import read
    results = read(options.results)
    if options.output.endswith(".vtkhdf"):
        solids.write(results, options.output, options.degrees, options.sectors)
    elif options.output.endswith(".png"):
        solids.draw(results, options.output, options.field, options.state, options.degrees, options.sectors)
    else:
        raise UserError(f"{options.output}: expected a name that ends in .vtkhdf or .png")
    print(f"wrote {options.output}")
    return 0


def report(options) -> int:
    """Write one HTML file about a run: how it ended, energies and their balance, force and pressure of each interface, rigid
    walls, fields, warnings, parts, timing. It needs no network and no other file. Killed and running runs are reported as
    far as they got."""
    from slideline_tools.report import write_report
    path = write_report(options.run_path, options.output, options.field, options.state,
                        options.scale, options.program)
    print(f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return 0


def wanted(text: str) -> list[str]:
    """The names of a comma list, each one of WHAT."""
    names = [name for name in text.split(",") if name]
    for name in names:
        if name not in WHAT:
            raise argparse.ArgumentTypeError(f"unknown '{name}'; there are {', '.join(WHAT)}")
    return names


def draw(options) -> int:
    """Draw the model of a deck: mesh by part, node sets, contact surfaces with walking direction and outward normals, held
    nodes, motions, initial velocities, loads, pressures, rigid bodies. The program reads the deck, so that the picture shows
    what would run."""
    from slideline_tools.draw import draw as draw_model
    from slideline_tools.names import counted
    stem = pathlib.Path(options.deck).resolve().name
    for ending in (".k", ".key", ".dyn", ".effective"):
        stem = stem.removesuffix(ending)
    path = options.output or f"{stem}.png"
    model = draw_model(options.deck, path, options.program, options.overrides, options.show,
                       options.zoom)
    counts = {"node": model.points, "element": model.cells, "part": model.parts,
              "interface": model.interfaces}
    print(f"wrote {path} (" + ", ".join(counted(len(some), name) for name, some in counts.items())
          + ")")
    for words in model.warnings:
        print(f"warning: {words}")
    if model.not_drawn:
        print("not drawn: " + ", ".join(model.not_drawn))
    return 0
