#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Put nonsense into every honoured field of every keyword, one at a time, and list what is accepted and what it does.

    sweep_fields.py --program build/release/slideline [--keywords '*DAMPING*' ...] [--output FOLDER] [--check]

The decks are those of doc/examples, which hold every keyword that the reader knows. What is refused must name the field;
what is accepted runs, and its energies are compared with those of the deck as it was. The table goes to FOLDER/fields.csv:
keyword, card, field, value, outcome (refused, warned, accepted), message, exit status of the run, largest kinetic energy
over that of the deck as it was, energy ratio. --check leaves the runs out. A quarter of an hour with runs.
Exit status: 0, or 1 where a run crashed, hung, held a number that is not finite, or a refusal did not name the field.
"""
import argparse
import csv
import fnmatch
import math
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
TABLES = ROOT / "src/deck/schema/deck_schema_tables.f90"
EXAMPLES = ROOT / "doc/examples"
REALS = ("-1.0", "-1.0E-3", "0.0", "1.0E-30", "1.0E+30", "1.0E+40", "1.0E+300", "NAN", "INF", "-INF", "x")
INTEGERS = ("-1", "0", "3", "99", "2147483647", "99999999999", "1.5", "x")
CRASH = re.compile(r"Sanitizer|runtime error|received signal|Backtrace|Fortran runtime|HDF5-DIAG", re.IGNORECASE)
#: seconds of one run
LIMIT = 20
#: cards that repeat, by keyword: first line of the rows, and their card
ROWS = {"DEFINE_CURVE": 2, "DEFINE_TABLE": 2}
#: whole numbers that name a node, a set, a part, a curve: what they may be is for the resolver
REFERENCE = re.compile(r"^(B?\d?[NPSME]?S?ID\d*|N\d|LC.*|NSIDEX|SURF[AB]|(S|P|TB|HG|M|SEC)ID|ID\d?|B\d(BEG|END)|EID|SSID)$")


def schema(path=TABLES):
    """keyword -> (has a title option, [cards: [(name, kind, treatment, width)]])."""
    text = re.sub(r"'\s*&\n\s*//'", "", path.read_text(encoding="utf-8"))
    keywords, cards = {}, None
    for line in re.findall(r"^ +'([^']*)'[,\]]", text, re.MULTILINE):
        if line[0] != " ":
            name, _, options = line.partition(" ")
            cards = keywords[line.partition("=")[2]][1] if "=" in line else []
            keywords[name] = ("t" in options, cards)
            continue
        fields = []
        for word in line.split():
            name, kind, treatment, width = re.match(r"([^:]+):([ifax])([swr]?)(\d*)", word).groups()
            fields.append((name, kind, treatment or "h", int(width or 10)))
        cards.append(fields)
    return keywords


def blocks(lines):
    """(keyword, titled, [line numbers of its cards]) of each block of a deck."""
    found = []
    for number, line in enumerate(lines):
        if line.startswith("*"):
            name = line[1:].split()[0].upper().rstrip("+-%")
            found.append((name, []))
        elif found and not line.startswith("$"):
            found[-1][1].append(number)
    return found


def cut(line, fields):
    if "," in line:
        return [word.strip() for word in line.split(",")]
    words, start = [], 0
    for *_, width in fields:
        words.append(line[start:start + width].strip())
        start += width
    return words


def cards_of(name, numbers, keywords):
    """(canonical keyword, [(line number or None, index of the card)]) of a block; None where it is not known."""
    titled = name not in keywords
    if titled:
        name = re.sub(r"_(TITLE|ID)$", "", name)
    if name not in keywords:
        return None
    cards = keywords[name][1]
    numbers = numbers[1:] if titled else numbers
    if name == "PART":
        return name, [(numbers[1], 1)] if len(numbers) > 1 else []
    found = [(numbers[k] if k < len(numbers) else None, k) for k in range(len(cards))]
    return name, found


def variants(keywords, patterns):
    """(example, keyword, card, field number, name, value, text) of every variant."""
    done = set()
    for path in sorted(EXAMPLES.glob("*.k")):
        if re.search(r"^\$ Status:", path.read_text(encoding="utf-8"), re.MULTILINE):
            continue
        lines = path.read_text(encoding="utf-8").splitlines()
        implicit = any("CONTROL_IMPLICIT_GENERAL" in line for line in lines)
        for name, numbers in blocks(lines):
            known = cards_of(name, numbers, keywords)
            if known is None or not any(fnmatch.fnmatch("*" + known[0], pattern) for pattern in patterns):
                continue
            name, places = known
            for k, (number, card) in enumerate(places):
                for j, field in enumerate(keywords[name][1][card]):
                    key = (name, card, j, implicit)
                    if field[2] != "h" or field[1] not in "if" or key in done:
                        continue
                    if number is None and any(place is None for place, _ in places[:k]):
                        continue  # a card further on than the next missing one
                    done.add(key)
                    for value in REALS if field[1] == "f" else INTEGERS:
                        yield path, name, card, j, field[0], value, changed(lines, numbers, number, keywords[name][1][card],
                                                                            j, value)


def changed(lines, numbers, number, fields, j, value):
    new = list(lines)
    words = cut(lines[number], fields) if number is not None else []
    words += [""] * (len(fields) - len(words))
    words[j] = value
    card = ",".join(words)
    if number is not None:
        new[number] = card
    else:
        new.insert((numbers[-1] if numbers else len(lines) - 1) + 1, card)
    return "\n".join(new) + "\n"


def run(program, words, folder):
    """(exit status or None where it hung, standard error)."""
    try:
        done = subprocess.run([program, *words], cwd=folder, capture_output=True, timeout=LIMIT, stdin=subprocess.DEVNULL,
                              check=False)
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stderr.decode("utf-8", errors="replace")


def energies(folder):
    """(largest kinetic energy, furthest energy ratio from one) of a run; what is not finite counts as infinite."""
    kinetic, ratio = 0.0, 1.0
    for path in folder.glob("*.glstat.csv"):
        with open(path, newline="", encoding="ascii", errors="replace") as stream:
            for row in csv.DictReader(stream):
                values = [float(row[name]) if math.isfinite(float(row[name])) else math.inf
                          for name in ("kinetic", "energy_ratio")]
                kinetic = max(kinetic, values[0])
                if abs(values[1] - 1.0) > abs(ratio - 1.0):
                    ratio = values[1]
    return kinetic, ratio


class Sweep:
    """Runs variants and judges them."""

    def __init__(self, program, runs):
        self.program, self.runs = program, runs
        self.base = {}

    def kinetic(self, path):
        if path not in self.base:
            with tempfile.TemporaryDirectory() as folder:
                run(self.program, [f"i={path}", f"d={folder}"], EXAMPLES)
                self.base[path] = energies(Path(folder))[0]
        return self.base[path]

    def judge(self, variant):
        """A row of the table, and what is wrong."""
        path, keyword, card, j, name, value, text = variant
        row = {"keyword": "*" + keyword, "card": card + 1, "field": name, "value": value, "deck": path.name}
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "parts").symlink_to(EXAMPLES / "parts")
            deck = Path(folder) / "deck.k"
            deck.write_text(text, encoding="utf-8")
            status, said = run(self.program, ["check", "deck.k"], folder)
            lines = [line for line in said.splitlines() if line.startswith(("deck.k:", "warning:", "parts"))]
            row["message"] = "; ".join(lines)[:300]
            row["outcome"] = {0: "warned" if lines else "accepted", 1: "refused"}.get(status, "failed")
            trouble = "" if status in (0, 1, 2) and not CRASH.search(said) else f"check ended with {status}: {said[-300:]}"
            if status == 0 and self.runs:
                words = re.search(r"^\$ Run: *(.*)$", text, re.MULTILINE)
                row["status"], said = run(self.program, ["deck.k", "d=out", *(words[1].split() if words else [])], folder)
                before, (kinetic, ratio) = self.kinetic(path), energies(Path(folder) / "out")
                row["growth"] = f"{kinetic / before:.3g}" if before > 0.0 else "-"
                row["energy_ratio"] = f"{ratio:.4g}"
                if row["status"] not in (0, 2) or CRASH.search(said):
                    trouble = f"the run ended with {row['status']}: {said[-300:]}"
                if not row["message"] and said:
                    row["message"] = said.splitlines()[0][:300]
        return row, trouble


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--keywords", nargs="+", default=["*"])
    parser.add_argument("--output", type=Path, default=Path("."))
    parser.add_argument("--check", action="store_true", help="no runs")
    options = parser.parse_args()
    sweep = Sweep(str(Path(options.program).resolve()), not options.check)
    options.output.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(2) as pool:
        results = list(pool.map(sweep.judge, variants(schema(), options.keywords)))
    names = ["keyword", "card", "field", "value", "outcome", "status", "growth", "energy_ratio", "deck", "message"]
    with open(options.output / "fields.csv", "w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, names, lineterminator="\n", restval="")
        writer.writeheader()
        writer.writerows(row for row, _ in results)
    for row, trouble in results:
        if trouble:
            print(f"{row['keyword']} {row['field']}={row['value']} ({row['deck']}): {trouble}")
    print(f"{len(results)} values, {sum(row['outcome'] == 'refused' for row, _ in results)} refused, "
          f"{sum(bool(trouble) for _, trouble in results)} wrong")
    return 1 if any(trouble for _, trouble in results) or not results else 0


if __name__ == "__main__":
    sys.exit(main())
