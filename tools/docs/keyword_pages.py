# SPDX-License-Identifier: MIT
"""One page for each keyword of doc/keywords.md: cards, fields, remarks, examples.

    keyword_pages.py    puts the fields of src/deck/schema into doc/keywords.md, which has their meanings
"""
import dataclasses
import itertools
import re
import textwrap

import examples

MEANING = {
    "honoured": "",
    "no effect": "read, without effect",
    "warning": "without effect, with one warning",
    "refused": "an error unless blank, 0 or the default",
}


@dataclasses.dataclass
class Keyword:
    """One section of doc/keywords.md."""

    name: str
    group: str
    titled: bool      #: takes _TITLE or _ID with a text line
    remarks: str
    fields: list      #: rows (card, field, columns, kind, default, range, treatment, meaning)

    @property
    def file(self):
        return f"{self.name.lower()}.md"


SCHEMA = examples.ROOT / "src/deck/schema"
KINDS = {"i": "integer", "f": "real", "a": "text"}
TREATMENTS = {"": "honoured", "s": "no effect", "w": "warning", "r": "refused"}
WORD = re.compile(r"([^:]+):([ifax])([swr]?)(\d*)(?:[=~]([^<>|]+))?([<>|]\S+)?")
#: a row of fields: card and field; columns, kind, default and range; treatment and meaning
ROW = re.compile(r"\| (\d+) (\S+) \| ([^|]*) \| (?:\*(no effect|warning|refused)\*(?:; )?)?(.*?) ?\|$")
HEAD = "| card, field | columns, kind = default, range | meaning |\n|---|---|---|\n"
#: the table of fields of a section, and the paragraph of those that need no meaning
FIELDS = re.compile(re.escape(HEAD) + r"(?:\|.*\n)*\n?")
OTHERS = re.compile(r"^Other fields: (?:\S.*\n)*\n?", re.M)
SAME = re.compile(r"^Cards and fields as those of \[`\*(\S+)`\]\(\S+\)(?:\.|, but for:)\n?", re.M)


def table_lines(name, source=None):
    """The lines of one table of the reader."""
    source = source or "".join(path.read_text(encoding="utf-8") for path in sorted(SCHEMA.glob("deck_schema*.f90")))
    body = re.search(rf":: {name}\(\*\) = \[character\(\d+\) :: &\n(.*?)\]\n", source, re.S).group(1)
    return [row.replace("''", "'") for row in re.findall(r"'((?:[^']|'')*)'", re.sub(r"' &\n\s*//'", "", body))]


def range_text(notation):
    """The range of a field as an interval, `[0,1)` without 1, as `>0`, or as the numbers allowed, `0/1/2`."""
    if notation.startswith("|"):
        return notation[1:].replace("|", "/")
    low, high = (re.findall(r"([<>]=?)([^<>]+)", notation) + [None])[:2]
    return notation if not high else f"{'[' if low[0] == '>=' else '('}{low[1]},{high[1]}{']' if high[0] == '<=' else ')'}"


def read_schema():
    """keyword -> rows [card, field, columns, kind, default, range, treatment] of the reader's tables."""
    found, rows = {}, None
    source = (SCHEMA / "deck_schema_tables.f90").read_text(encoding="utf-8")
    for line in (line for name in re.findall(r":: (table_\w+)\(\*\)", source) for line in table_lines(name, source)):
        if not line.startswith(" "):
            rows, card = found.setdefault(line.split()[0], []), 0
            rows += found[line.partition("=")[2]] if "=" in line else []
            continue
        card, column = card + 1, 1
        for word in line.split():
            name, kind, treatment, width, default, limits = WORD.fullmatch(word).groups()
            width = int(width or 10)
            if name != "-":
                rows.append([str(card), name, f"{column}-{column + width - 1}", KINDS[kind], default or "",
                             range_text(limits) if limits else "", TREATMENTS[treatment]])
            column += width
    return found


def row_line(row, meaning):
    """A field as a row of doc/keywords.md: all but its meaning is the reader's."""
    card, name, columns, kind, default, limits, treatment = row
    if treatment != "honoured":
        meaning = f"*{treatment}*" + (f"; {meaning}" if meaning else "")
    kind += (f" = {default}" if default else "") + (f" {limits}" if limits else "")
    return f"| {card} {name} | {columns} {kind} | {meaning} |"


def others_text(rows):
    """The fields without a meaning of their own, by treatment and card."""
    words = []
    for treatment in TREATMENTS.values():
        cards = {}
        for row in rows:
            if row[6] == treatment:
                cards.setdefault(row[0], []).append(row[1])
        if cards:
            words.append(f"*{treatment}* " + ", ".join(f"{card} {' '.join(names)}" for card, names in cards.items()))
    return textwrap.fill(f"Other fields: {'; '.join(words)}.", 120, break_on_hyphens=False) + "\n\n" if rows else ""


def named_fields(text):
    """(card, field) of all that `others_text` names."""
    found, card = set(), ""
    for word in re.findall(r"\b\d\b|\b[A-Z]\w*", text.partition(":")[2]):
        card = word if word.isdigit() else card
        found.add((card, word))
    return found


def made_page(text):
    """doc/keywords.md with the fields of the reader: columns, kind, default, range and treatment; meanings stay."""
    schema, parts = read_schema(), re.split(r"^(?=##)", text, flags=re.M)
    for k, part in enumerate(parts):
        found = [match for pattern in (FIELDS, OTHERS) if (match := pattern.search(part))]
        if not part.startswith("### *") or not found:
            continue
        others = OTHERS.search(part)
        meanings = {(row[1], row[2]): row[5] for line in part.splitlines() if (row := ROW.match(line))}
        there = meanings.keys() | (named_fields(others[0]) if others else set())
        rows = [row for row in schema[part[5:].split()[0]] if not SAME.search(part) or tuple(row[:2]) in there]
        bare = [row for row in rows if row[6] != "honoured" and not meanings.get(tuple(row[:2]))]
        shown = [row_line(row, meanings.get(tuple(row[:2]), "")) + "\n" for row in rows if row not in bare]
        made = (HEAD + "".join(shown) + "\n" if shown else "") + others_text(bare)
        head, tail = part[:found[0].start()], OTHERS.sub("", FIELDS.sub("", part[found[0].start():]))
        parts[k] = head + made + tail
    return "".join(parts).rstrip("\n") + "\n"


def read_fields(name, body, schema, others=()):
    """Rows [card, field, columns, kind, default, range, treatment, meaning] of a section of doc/keywords.md."""
    same = SAME.search(body)
    meanings = {} if not same else {
        (row[0], row[1]): row[7] for row in next(other.fields for other in others if other.name == same[1])}
    for line in body.splitlines():
        if row := ROW.match(line):
            meanings[row[1], row[2]] = row[5]
    return [[*row, meanings.get((row[0], row[1]), "")] for row in schema[name]]


def read_keywords(text):
    """The keywords of doc/keywords.md in their order."""
    found, group, schema = [], "", read_schema()
    for part in re.split(r"^(?=##)", text, flags=re.M):
        head, _, body = part.partition("\n")
        if head.startswith("## "):
            group = head[3:].strip()
        if not head.startswith("### *"):
            continue
        remarks = "\n".join(line for line in OTHERS.sub("", SAME.sub("", body)).splitlines() if not line.startswith("|")).strip()
        name, _, mark = head[5:].partition(" ")
        found.append(Keyword(name, group, mark.strip() == "(title)", remarks, read_fields(name, body, schema, found)))
    return found


def card_table(rows):
    """The card as manuals draw it: one column for each field."""
    lines = [["Columns", *(row[2] for row in rows)], ["Field", *(row[1] for row in rows)],
             ["Type", *({"integer": "I", "real": "F", "text": "A"}[row[3]] for row in rows)]]
    if any(row[4] for row in rows):
        lines.append(["Default", *(row[4] for row in rows)])
    if any(row[5] for row in rows):
        lines.append(["Range", *(row[5] for row in rows)])
    head, *rest = ["| " + " | ".join(line) + " |" for line in lines]
    return [head, "|" + "---|" * (len(rows) + 1), *rest]


def field_table(rows):
    """What the fields mean, card by card."""
    lines = ["| card | field | treatment | meaning |", "|---|---|---|---|"]
    for card, field, *_, treatment, meaning in rows:
        lines.append(f"| {card} | **{field}** | {treatment} | {meaning or MEANING[treatment]} |")
    return lines


def card_lines(keyword):
    cards = sorted({int(row[0]) for row in keyword.fields})
    lines = ["## Cards", ""]
    if keyword.titled:
        lines += [f"`*{keyword.name}_TITLE` and `*{keyword.name}_ID` have one more line, a title, "
                  "before card 1.", ""]
    for card in cards:
        rows = [row for row in keyword.fields if int(row[0]) == card]
        lines += [f"Card {card}", "", '<div class="card" markdown>', "", *card_table(rows), "",
                  "</div>", ""]
    return lines + ["## Fields", "", *field_table(keyword.fields), ""]


def expectation_table(example):
    """What the run must give, and what the test finds it to be."""
    if not example.expectations:
        return []
    lines = ["The run is tested for:", "", '<div class="expect" markdown>', "",
             "| quantity | closed form | value | within |", "|---|---|---|---|"]
    for entry in example.expectations:
        where = ", ".join(f"{key} {value}" for key, value in entry.where.items())
        where = f" of {where}" if where else ""
        table = "element field" if entry.table == "cell" else entry.table
        pick = {"rows": "number of rows"}.get(entry.pick, entry.pick)
        column = "" if entry.pick == "rows" else f" `{entry.column}`"
        lines.append(f"| {pick}{column}{where} ({table}) | `{entry.formula}` | "
                     f"{entry.value:.6g} | {entry.tolerance:g} |")
    return [*lines, "", "</div>", ""]


def deck_block(path, keyword):
    """A deck as a code block with its name and the keyword marked, without the head of the example."""
    lines = path.read_text(encoding="utf-8").splitlines()
    lines = lines[next(k for k, line in enumerate(lines) if not line.startswith("$")):]
    marked, inside = [], False
    for number, line in enumerate(lines, 1):
        if line.startswith("*"):
            inside = re.fullmatch(rf"\*{keyword}(_TITLE|_ID)?", line.strip()) is not None
        if inside:
            marked.append(str(number))
    mark = f' hl_lines="{" ".join(marked)}"' if marked else ""
    return [f'```text title="{path.relative_to(examples.ROOT)}"{mark}', *lines, "```", ""]


def example_lines(example, keyword):
    lines = [f"## Example: {example.title[0].lower()}{example.title[1:]}", ""]
    for paragraph in example.paragraphs:
        lines += [paragraph, ""]
    lines += ["```sh", example.command, "```", ""]
    lines += expectation_table(example)
    lines += [f"The log says: `{text}`", ""] if (text := "; ".join(example.log_texts)) else []
    if example.files:
        lines += ["It leaves " + ", ".join(f"`{name}`" for name in example.files) + ".", ""]
    for path in [example.path, *examples.included_files(example)]:
        lines += deck_block(path, keyword)
    return lines


def page(keyword, shown, others):
    """The page of a keyword; `others` are examples that use it in passing."""
    lines = [f"# *{keyword.name}", "", f"[{keyword.group}](index.md)", ""]
    if keyword.remarks:
        lines += [keyword.remarks, ""]
    if keyword.fields:
        lines += card_lines(keyword)
    for example in shown:
        lines += example_lines(example, keyword.name)
    if others:
        names = ", ".join(f"`{example.path.name}`" for example in others)
        lines += ["## Also used in", "", f"{names} of `doc/examples`.", ""]
    return "\n".join(lines)


def index_page(keywords, shown):
    """The list of all keywords by group."""
    lines = ["# Keyword manual", "",
             "One page for each keyword: its cards, what each field does here, and a deck that runs "
             "in a moment. [How lines and fields are read](../keywords.md#lines) and what is ignored "
             "or refused by name stands on the [page with all keywords](../keywords.md).", ""]
    for group, some in itertools.groupby(keywords, key=lambda keyword: keyword.group):
        lines += [f"## {group}", "", "| keyword | example |", "|---|---|"]
        for keyword in some:
            titles = "; ".join(example.title for example in shown[keyword.name])
            lines.append(f"| [*{keyword.name}]({keyword.file}) | {titles} |")
        lines.append("")
    return "\n".join(lines)


def write_pages(text, folder):
    """All keyword pages into a folder; returns the keywords."""
    keywords = read_keywords(text)
    decks = examples.read_examples()
    shown = {keyword.name: [deck for deck in decks if keyword.name in deck.keywords]
             for keyword in keywords}
    folder.mkdir(parents=True, exist_ok=True)
    for keyword in keywords:
        uses = re.compile(rf"^\*{keyword.name}(_TITLE|_ID)?\s*$", re.M | re.I)
        others = [deck for deck in decks if deck not in shown[keyword.name]
                  and uses.search(deck.path.read_text(encoding="utf-8"))]
        (folder / keyword.file).write_text(page(keyword, shown[keyword.name], others),
                                           encoding="utf-8")
    (folder / "index.md").write_text(index_page(keywords, shown), encoding="utf-8")
    return keywords


if __name__ == "__main__":
    PAGE = examples.ROOT / "doc/keywords.md"
    PAGE.write_text(made_page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
