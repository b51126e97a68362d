# SPDX-License-Identifier: MIT
"""Break decks the way people and programs break them: a mutator that knows keywords, cards and fields."""
import random
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/rejected"))

from refused_decks import refused_decks  # noqa: E402

#: field values at the edges of what numbers are
EDGES = ("0", "-0", "-0.0", "1", "-1", "2", "-2", "3", "7", "0.5", "1e-308", "4.9e-324", "-1e-30", "1e-12",
         "1e12", "1e30", "1e39", "-1e39", "1e40", "1.1e40", "1e-39", "-1e-40", "1e99", "-1e99", "1e100", "1e101", "1e308", "-1e308", "1e309", "1e999999999999",
         "NaN", "nan", "inf", "-Infinity", "2147483646", "2147483647", "2147483648", "-2147483647",
         "-2147483648", "4294967296", "9223372036854775807", "9223372036854775808",
         "123456789012345678901234567890", "1.5", "1d3", "1.0+5", "0x10", "1e", "e5", ".", "-", "+", "--1",
         "1 2", "abc", "&", "&x", "-&nothing", "<1+1>", "&(1/0)", "'", '"', "*", "$", "1.e+", "\x00", "\xff",
         "999999999", "99999999", "1000000", "8", "9", "10", "13", "100")

#: decks of changes for runs that go on
CHANGES = ("*CONTROL_TERMINATION\n0.004,\n", "*DATABASE_BINARY_RUNRSF\n3,\n*DATABASE_GLSTAT\n1.0e-3,\n",
           "*KEYWORD\n*DATABASE_BINARY_D3PLOT\n1.0e-3,\n*DATABASE_RCFORC\n0.0005,\n*END\n",
           "*CONTROL_TERMINATION\n0.004,60\n*DATABASE_BINARY_D3DUMP\n7,\n*DATABASE_NODOUT\n1e-3,\n")

WORDS = re.compile(r"[^\s,]+")


def corpus(largest: int = 60000) -> list[tuple[str, list[str]]]:
    """Names and lines of the decks that are broken: examples, scenes, refused decks."""
    folders = ("doc/examples", "input/*", "tests/lab/fuzz/decks")
    found = [path for folder in folders for path in sorted(ROOT.glob(f"{folder}/*.k"))]
    decks = [(str(path.relative_to(ROOT)), read(path)) for path in found if path.stat().st_size <= largest]
    return decks + [(f"tests/rejected/{deck.name}", deck.text.splitlines()) for deck in refused_decks()]


def read(path: Path) -> list[str]:
    """Lines of a deck; what it includes is named by its full path."""
    lines = path.read_text(encoding="latin-1").splitlines()
    return [str(path.parent.resolve() / line) if line.endswith(".k") and line[:1] not in "*$"
            and (path.parent / line).is_file() else line for line in lines]


def short(lines: list[str], cycles: int) -> list[str]:
    """The deck with an end after a few cycles (ENDCYC)."""
    out, at = list(lines), None
    for i, line in enumerate(out):
        if line.upper().startswith("*CONTROL_TERMINATION"):
            at = i + 1
        elif at is not None and not line.startswith("$"):
            out[i] = (WORDS.findall(line) or ["1.0"])[0] + f",{cycles}"
            at = None
    return out


def keywords(decks: list[list[str]]) -> list[str]:
    """All keywords of the decks and of the reference."""
    found = {line.split()[0] for deck in decks for line in deck if line.startswith("*")}
    text = (ROOT / "doc/keywords.md").read_text(encoding="utf-8")
    return sorted(found | set(re.findall(r"^#+ `?(\*[A-Z_0-9-]+)", text, re.MULTILINE)))


class Mutator:
    """Mutations of decks, from a seed."""

    def __init__(self, seed: int, decks: list[list[str]]):
        self.random = random.Random(seed)
        self.decks = decks
        self.keywords = keywords(decks)
        self.ways = [self.field] * 8 + [self.field_pair, self.remove, self.double, self.swap,
                                         self.keyword, self.block_move, self.block_remove, self.block_double,
                                         self.graft, self.shift_ids, self.parameter, self.expression, self.long_line,
                                         self.blank, self.many_fields, self.option, self.include]

    def mutate(self, lines: list[str], count: int) -> bytes:
        """A deck with `count` mutations, as bytes."""
        lines = list(lines)
        for _ in range(count):
            self.random.choice(self.ways)(lines)
            if not lines:
                lines.append("*KEYWORD")
        data = "\n".join(lines).encode("latin-1", errors="replace") + b"\n"
        return self.bytes(data) if self.random.random() < 0.12 else data

    def data_line(self, lines: list[str]) -> int:
        """A line of a card, or any line where there is none."""
        cards = [i for i, line in enumerate(lines) if line[:1] not in ("*", "$") and line.strip()]
        heads = [i for i in cards if i and lines[i - 1][:1] in ("*", "$")]
        # The first cards of blocks matter more than the many rows of a mesh.
        pick = heads if heads and self.random.random() < 0.7 else cards
        return self.random.choice(pick) if pick else self.random.randrange(len(lines))

    def blocks(self, lines: list[str]) -> list[tuple[int, int]]:
        """First and last line (not included) of all blocks."""
        starts = [i for i, line in enumerate(lines) if line.startswith("*")] + [len(lines)]
        return list(zip(starts, starts[1:]))

    def value(self) -> str:
        """A field at an edge, or just another number."""
        if self.random.random() < 0.7:
            return self.random.choice(EDGES)
        return f"{self.random.choice((1, -1)) * 10 ** self.random.uniform(-20, 20):.3e}"

    def field(self, lines: list[str]) -> None:
        """Another value in one field."""
        i = self.data_line(lines)
        fields = [f.strip() for f in lines[i].split(",")] if "," in lines[i] else WORDS.findall(lines[i])
        if not fields:
            return
        k = self.random.randrange(len(fields) + (self.random.random() < 0.3))
        fields[k:k + 1] = [self.value()]
        lines[i] = ",".join(fields)

    def field_pair(self, lines: list[str]) -> None:
        """Exchange two fields."""
        i = self.data_line(lines)
        fields = WORDS.findall(lines[i])
        if len(fields) > 1:
            a, b = self.random.sample(range(len(fields)), 2)
            fields[a], fields[b] = fields[b], fields[a]
            lines[i] = ",".join(fields)

    def remove(self, lines: list[str]) -> None:
        """Remove a line."""
        del lines[self.random.randrange(len(lines))]

    def double(self, lines: list[str]) -> None:
        """Repeat a line, there or elsewhere."""
        i = self.random.randrange(len(lines))
        lines.insert(i if self.random.random() < 0.6 else self.random.randrange(len(lines)), lines[i])

    def swap(self, lines: list[str]) -> None:
        """Exchange two cards."""
        a, b = self.data_line(lines), self.data_line(lines)
        lines[a], lines[b] = lines[b], lines[a]

    def keyword(self, lines: list[str]) -> None:
        """Another keyword above the same cards."""
        heads = [i for i, line in enumerate(lines) if line.startswith("*")]
        if heads:
            lines[self.random.choice(heads)] = self.random.choice(self.keywords)

    def option(self, lines: list[str]) -> None:
        """Something behind a keyword."""
        heads = [i for i, line in enumerate(lines) if line.startswith("*")]
        if heads:
            lines[self.random.choice(heads)] += self.random.choice(
                ("_ID", "_TITLE", "_SET", " +", " -", " %", "_", "X" * 90, " LONG=Y", " I10=Y", "\t", "_LOCAL"))

    def block_move(self, lines: list[str]) -> None:
        """Put a block elsewhere."""
        blocks = self.blocks(lines)
        if len(blocks) > 2:
            a, b = self.random.choice(blocks)
            moved = lines[a:b]
            del lines[a:b]
            at = self.random.choice(self.blocks(lines))[0]
            lines[at:at] = moved

    def block_remove(self, lines: list[str]) -> None:
        """Remove a block."""
        blocks = self.blocks(lines)
        if blocks:
            a, b = self.random.choice(blocks)
            del lines[a:b]

    def block_double(self, lines: list[str]) -> None:
        """Repeat a block."""
        blocks = self.blocks(lines)
        if blocks:
            a, b = self.random.choice(blocks)
            lines[b:b] = lines[a:b]

    def graft(self, lines: list[str]) -> None:
        """Put a block of another deck in."""
        other = self.random.choice(self.decks)
        blocks, here = self.blocks(other), self.blocks(lines)
        if blocks:
            a, b = self.random.choice(blocks)
            at = self.random.choice(here)[0] if here else 0
            lines[at:at] = other[a:b]

    def shift_ids(self, lines: list[str]) -> None:
        """One id, everywhere, becomes another."""
        words = [w for w in WORDS.findall(lines[self.data_line(lines)]) if w.isdigit()]
        if words:
            old, new = self.random.choice(words), self.value()
            pattern = re.compile(rf"(?<![\w.+-]) {{0,9}}\b{old}\b(?![.\w+-])")
            lines[:] = [line if line[:1] in "*$" else pattern.sub(f"{new:>10}", line) for line in lines]

    def parameter(self, lines: list[str]) -> None:
        """Use a parameter, defined or not."""
        i = self.data_line(lines)
        fields = WORDS.findall(lines[i])
        if fields:
            fields[self.random.randrange(len(fields))] = self.random.choice(("&q", "-&q", "&q&q", "&", "&qq"))
            lines[i] = ",".join(fields)
        if self.random.random() < 0.7:
            kind = self.random.choice(("R", "I", "C", "X", ""))
            lines[1:1] = [f"*PARAMETER{self.random.choice(('', '_LOCAL', '_EXPRESSION', '_DUPLICATION'))}",
                          f"{kind}{'q':>9},{self.value()}"]

    def expression(self, lines: list[str]) -> None:
        """A parameter from an expression."""
        atoms = ("1", "q", "0", "1e308", "-1", "2**3**9", "sin(1)", "sqrt(-1)", "log(0)", "(((1)))", "1/0", "max(1,2)",
                 "int(1e300)", "mod(1,0)", "(" * 300, ")", "1e", "..", "exp(1000)", "nint(1e99)")
        text = "".join(self.random.choice(atoms) + self.random.choice("+-*/,() ") for _ in range(3))
        lines[1:1] = ["*PARAMETER_EXPRESSION", f"{self.random.choice('RI')} q,{text}"]

    def long_line(self, lines: list[str]) -> None:
        """A line that is too long."""
        i = self.random.randrange(len(lines))
        lines[i] += self.random.choice((" ", "1", ",", "x,", "&")) * self.random.choice((80, 300, 5000, 200000))

    def blank(self, lines: list[str]) -> None:
        """A blank line, or a card of blanks."""
        lines.insert(self.random.randrange(len(lines) + 1), self.random.choice(("", " " * 80, ",,,,,,,,", "\r", "$")))

    def many_fields(self, lines: list[str]) -> None:
        """More fields than a card has."""
        i = self.data_line(lines)
        lines[i] = ",".join([lines[i]] + [self.value() for _ in range(self.random.randint(1, 20))])

    def include(self, lines: list[str]) -> None:
        """Include something."""
        names = ("deck.k", ".", "..", "/", "/dev/null", "/dev/zero", "nothing.k", "./deck.k", "../deck.k", "x" * 5000,
                 "a +", "", " +", "/dev/urandom", "fifo", "/proc/self/mem", "/proc/cpuinfo")
        at = self.random.choice(self.blocks(lines) or [(0, 0)])[0]
        lines[at:at] = [self.random.choice(("*INCLUDE", "*INCLUDE_PATH", "*INCLUDE_PATH_RELATIVE")),
                        self.random.choice(names)]

    def words(self) -> list[str]:
        """Words behind the deck on the command line: mostly none."""
        names = ("ctype", "ngauss", "pen", "punit", "pent", "vdc", "endtim", "dt", "tssfac", "p:ctype", "p:q", "p:",
                 "ncpu", "timing", "jobid", "memory", "ctype.1", "pen.99999999999", "x", "", "-", "r", "i")
        if self.random.random() < 0.8:
            return []
        return [(self.random.choice(names) + "=" + self.value()).replace("\x00", "")
                for _ in range(self.random.choice((1, 1, 2, 5)))]

    def bytes(self, data: bytes) -> bytes:
        """Damage that knows nothing of lines."""
        data, way = bytearray(data), self.random.randrange(5)
        if way == 0:
            del data[self.random.randrange(len(data)):]
        elif way == 1:
            for _ in range(self.random.choice((1, 10, 100))):
                data[self.random.randrange(len(data))] = self.random.randrange(256)
        elif way == 2:
            at = self.random.randrange(len(data))
            data[at:at] = self.random.randbytes(self.random.choice((1, 10, 1000)))
        elif way == 3:
            data = bytearray(bytes(data).replace(b"\n", self.random.choice((b"\r\n", b"\r", b"\n\n", b" "))))
        else:
            a, b = sorted(self.random.randrange(len(data)) for _ in range(2))
            del data[a:b]
        return bytes(data)
