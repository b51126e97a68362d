#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What each material law costs: instructions and ns per element and step of the one-point routine, gather and forces included.

usage: laws.py --build FOLDER [--kernel PROGRAM] [--rounds N] [--doc FOLDER]

`--build`: a build for x86-64-v3 with bench_kernel, whose instructions callgrind counts. Times are those of `--kernel` (the same where
it is not given, then with a yardstick for the same instructions), in turn with the yardstick, so that their ratio to K stands on a
busy machine; 0 rounds: no times.
Prints a table, and with `--doc` writes the page FOLDER/studies/speed_laws.md.
"""
import argparse
import re
import statistics
import subprocess
import tempfile
from pathlib import Path

import counts
import elements
from measuring import HERE
from slideline_tools.studies.common import write_page

PAGE = """# Speed of the material laws

This page is written by `tests/lab/bench/laws.sh --publish`: do not edit it.

What one element costs in a step with each law: the routine of plane one-point quads alone, with the gathering of nodes, forces and step limit, on one chunk
of 64 elements whose data stay in the L1 cache. **Instructions** are retired ones by callgrind, of what is built for x86-64-v3 (four reals a vector), {linked} link-time optimisation;
they do not depend on the machine or its load. **K** is the yardstick of [speed](speed.md), built for the same vectors and measured before and after each run; medians of {rounds} rounds. All elements yield where the law can,
but for the rows *elastic*, where none does: a chunk that stays elastic forms no power.

{table}
- 098 and 015 form the flow stress of Johnson and Cook at the end of the step by Newton's method, 16 elements at once, with logarithms and powers of their own
  (`src/base/vector_functions.f90`). A call of the library for each took 2111 instructions more than elastic for 098, 2371 for 015 and 2448 with damage.
- 015 and whatever may fail keep energy, pressure and volume of the element (an equation of state, `p = -K ln v` where the deck has none): 85 to 110 instructions.
- 007, 027 and 063 give the whole stress, the first two with bounds of their stiffness for the step limit.
"""
COPPER = (8930.0, 46.0e9, 124.0e9, 0.34)
CALLS = 400  # a round; more would melt what heats


def cards(*keywords, eos=0, curve=()):
    """A law by its keywords: (name, (fields, values...), ...) each; and a curve 2."""
    def write(deck):
        if curve:
            deck.curve(2, "of the law", curve)
        for name, *lines in keywords:
            deck.keyword(name)
            for fields, *values in lines:
                deck.card(fields, *values)
        return eos
    return write


def johnson_cook(damage=(), spall=0.0, first=9.0e5):
    rho, shear, young, poisson = COPPER
    return ("MAT_JOHNSON_COOK", ("mid ro g e pr", 1, rho, shear, young, poisson),
            ("a b n c m tm tr epso", first, 2.92e8, 0.31, 0.025, 1.09, 1356.0, 293.0, 1.0),
            ("cp pc spall it d1 d2 d3 d4", 383.0, -1.0e12 if spall else 0.0, spall, 0.0, *(damage or (0.0,) * 4)),
            ("d5", 1.0 if damage else 0.0))


def simplified(rate_form=0.0, first=9.0e5):
    return ("MAT_SIMPLIFIED_JOHNSON_COOK", ("mid ro e pr vp", 1, COPPER[0], *COPPER[2:], rate_form),
            ("a b n c psfail sigmax sigsat epso", first, 2.92e8, 0.31, 0.025, 0.0, 0.0, 0.0, 1.0))


def piecewise(*rate):
    return ("MAT_PIECEWISE_LINEAR_PLASTICITY", ("mid ro e pr sigy etan", 1, COPPER[0], *COPPER[2:], 1.0e5, 1.0e9),
            *([("c p", *rate)] if rate else []))


def plastic(tangent=0.0, beta=1.0, failure=0.0):
    return ("MAT_PLASTIC_KINEMATIC", ("mid ro e pr sigy etan beta", 1, *COPPER[:1], *COPPER[2:], 1.0e5, tangent, beta),
            ("src srp fs vp", 0.0, 0.0, failure, 0.0))


GRUNEISEN = ("EOS_GRUNEISEN", ("eosid c s1 s2 s3 gamao a e0", 1, 3940.0, 1.489, 0.0, 0.0, 1.99, 0.47, 0.0), ("v0", 1.0))
POLYNOMIAL = ("EOS_LINEAR_POLYNOMIAL", ("eosid c0 c1 c2 c3 c4 c5 c6", 1, 0.0, 1.4e11, 2.0e11, 3.0e11, 2.0, 2.0, 0.0),
              ("e0 v0", 0.0, 1.0))
ELASTIC = ", elastic"  # nothing yields
RUBBER = ("MAT_MOONEY-RIVLIN_RUBBER", ("mid ro pr a b", 1, 1100.0, 0.499, 4.0e5, 1.0e5))
BLATZ_KO = ("MAT_BLATZ-KO_RUBBER", ("mid ro g", 1, 1100.0, 1.0e6))
FOAM = ("MAT_CRUSHABLE_FOAM", ("mid ro e pr lcid tsc", 1, 100.0, 1.0e7, 0.1, 2, 1.0e5))
VISCOUS = ("MAT_NULL", ("mid ro pc mu", 1, 8930.0, 0.0, 1.0))
LAWS = {
    "001 elastic": cards(("MAT_ELASTIC", ("mid ro e pr", 1, COPPER[0], *COPPER[2:]))),
    "003 isotropic": cards(plastic()),
    "003 kinematic": cards(plastic(1.0e9, 0.5)),
    "003 isotropic, FAIL": cards(plastic(failure=10.0)),
    "024": cards(piecewise()),
    "024, Cowper and Symonds": cards(piecewise(40.0, 5.0)),
    "098": cards(simplified()),
    "098, VP 1": cards(simplified(1.0)),
    "098" + ELASTIC: cards(simplified(first=1.0e12)),
    "015": cards(johnson_cook()),
    "015" + ELASTIC: cards(johnson_cook(first=1.0e12)),
    "015, damage": cards(johnson_cook((100.0, 100.0, -1.5, 0.01))),
    "015, Gruneisen": cards(johnson_cook(), GRUNEISEN, eos=1),
    "015, damage, SPALL 2, Gruneisen": cards(johnson_cook((100.0, 100.0, -1.5, 0.01), 2.0), GRUNEISEN, eos=1),
    "010, Gruneisen": cards(("MAT_ELASTIC_PLASTIC_HYDRO", ("mid ro g sigy eh", 1, *COPPER[:2], 1.0e5, 1.0e9)), GRUNEISEN, eos=1),
    "009, viscous, Gruneisen": cards(VISCOUS, GRUNEISEN, eos=1),
    "009, viscous, linear polynomial": cards(VISCOUS, POLYNOMIAL, eos=1),
    "027": cards(RUBBER),
    "007": cards(BLATZ_KO),
    "063": cards(FOAM, curve=[(0.0, 1.0e5), (0.5, 2.0e5), (0.9, 2.0e6)]),
}


def words_of(name):
    """What the program of the routine is to be known of a law."""
    return ["elastic"] if name.endswith(ELASTIC) else []


def time_routine(kernel, deck, words):
    """ns per element, the best of the rounds of one run."""
    said = subprocess.run([kernel, deck, "1", "1000", str(CALLS), *words], check=True, capture_output=True, text=True).stdout
    return float(re.search(r"routine_ns,(\S+)", said)[1])


def measure_yardstick(words):
    """K, ns, of the instructions that the timed program has: those of this machine, or ARCH."""
    said = subprocess.run([HERE / "yardstick" / "run.sh", *words], check=True, capture_output=True, text=True).stdout
    return float(said.split(",")[1])


def measure(kernel, counted, folder, rounds):
    """[(law, instructions, over those of the elastic law, ns, K)]."""
    decks, words = {}, [] if kernel else [counts.ARCH]
    for number, (name, law) in enumerate(LAWS.items()):
        decks[name] = folder / f"law_{number}.k"
        elements.write_deck(decks[name], 64, False, law=law)
    counted_laws = {name: counts.count_routine(counted, deck, folder, words_of(name)) for name, deck in decks.items()}
    times, shares = ({name: [] for name in decks} for _ in range(2))
    for _ in range(rounds):
        for name, deck in decks.items():
            unit = measure_yardstick(words)
            times[name].append(time_routine(kernel or counted, deck, words_of(name)))
            shares[name].append(2.0 * times[name][-1] / (unit + measure_yardstick(words)))
    return [(name, found, found - counted_laws["001 elastic"],
             statistics.median(times[name]) if rounds else float("nan"),
             statistics.median(shares[name]) if rounds else float("nan")) for name, found in counted_laws.items()]


def table(rows):
    """The table in the form of the pages."""
    lines = ["| law | instructions | more than elastic | ns | K |", "|---|---|---|---|---|"]
    for name, found, more, time, share in rows:
        lines.append(f"| {name} | {found:.1f} | {more:.1f} | {time:.2f} | {share:.2f} |".replace("nan", ""))
    return "\n".join(lines) + "\n"


def linked(build):
    """Whether a build has link-time optimisation."""
    return "with" if "SLIDELINE_LTO:BOOL=ON" in (build / "CMakeCache.txt").read_text(encoding="utf-8") else "without"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--build", type=Path, required=True)
    parser.add_argument("--kernel", type=Path, help="the program to be timed")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--doc", type=Path, help="where the page goes")
    options = parser.parse_args()
    counted = options.build.resolve() / "tests" / "lab" / "bench" / "bench_kernel"
    with tempfile.TemporaryDirectory() as folder:
        text = table(measure(options.kernel, counted, Path(folder), options.rounds))
    print(text, end="")
    if options.doc:
        write_page(options.doc, "speed_laws", PAGE.format(rounds=options.rounds, table=text, linked=linked(options.build)))


if __name__ == "__main__":
    main()
