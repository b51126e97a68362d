# SPDX-License-Identifier: MIT
"""Puts the pages of the documentation site together: python site_source.py FOLDER

FOLDER/pages gets the Markdown of the repository (links and names of files turned to what they are
on the site), the generated keyword pages and the tables of messages; FOLDER/mkdocs.yml the settings with the navigation.
The page of a verification case begins with the title of its case.toml and ends with all its checks, where its results are
in build/release/verification.
"""
import json
import os
import pathlib
import re
import shutil
import sys

import keyword_pages
import messages

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "verification"))

from make_table import all_checks, read_cases, read_reports  # noqa: E402

RESULTS = ROOT / "build/release/verification"
LINK = re.compile(r"(!?\[[^\]]*\])\(([^)\s]+)\)")
NAMED_PAGE = re.compile(r"(?<!\[)`((?:[\w.]+/)*\w+\.md)`(?!\])")
NAMED_KEYWORD = re.compile(r"(?<!\[)`\*([A-Z0-9_-]+)`(?!\])")
FORTRAN = """# Fortran interface

[architecture.md](architecture.md) explains the layers. Every module, type and procedure that other modules may use, with arguments and units:

<a class="md-button" href="fortran/index.html">Open the Fortran interface</a>
"""


def site_paths():
    """Path in the repository -> path on the site, of every page."""
    pages = {path.relative_to(ROOT).as_posix(): path.relative_to(ROOT / "doc").as_posix()
             for path in (ROOT / "doc").rglob("*.md") if path.name != "ford.md"}
    pages["doc/studies/README.md"] = "studies/index.md"
    pages["doc/examples/README.md"] = "examples/index.md"
    pages["README.md"] = "quick_start.md"
    pages["tools/README.md"] = "tools.md"
    pages[".github/CONTRIBUTING.md"] = "contributing.md"
    for path in sorted((ROOT / "tests/verification").glob("*/README.md")):
        case = path.parent.name
        pages[f"tests/verification/{case}/README.md"] = f"cases/{case}.md"
    return pages


def relative(target, page):
    return os.path.relpath(target, os.path.dirname(page) or ".").replace(os.sep, "/")


def turn_links(text, source, page, pages, keywords):
    """The text of a page with links as the site needs them, outside of code blocks."""
    def link(found):
        label, target = found.groups()
        if re.match(r"[a-z]+:|#", target):
            return found.group(0)
        path, mark, anchor = target.partition("#")
        named = path
        path = os.path.normpath(os.path.join(os.path.dirname(source), path)).replace(os.sep, "/")
        if path not in pages and f"doc/{named}" in pages:  # pages made from doc/keywords.md keep its links
            path = f"doc/{named}"
        if path in pages:
            return f"{label}({relative(pages[path], page)}{mark}{anchor})"
        if path.startswith("doc/") and (ROOT / path).is_file():
            return f"{label}({relative(path[4:], page)})"
        return f"{label[1:-1]} (`{path}`)"

    def named_page(found):
        name = found.group(1)
        beside = os.path.normpath(os.path.join(os.path.dirname(source), name)).replace(os.sep, "/")
        path = next((path for path in (name, beside, f"doc/{name}") if path in pages), None)
        if path is None or pages[path] == page:
            return found.group(0)
        return f"[{found.group(0)}]({relative(pages[path], page)})"

    def named_keyword(found):
        file = f"keywords/{found.group(1).lower()}.md"
        if found.group(1) not in keywords or file == page:
            return found.group(0)
        return f"[{found.group(0)}]({relative(file, page)})"

    out, in_code = [], False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            in_code = not in_code
        if not in_code and not line.startswith(("    ", "#")):
            line = LINK.sub(link, line)
            line = NAMED_PAGE.sub(named_page, line)
            line = NAMED_KEYWORD.sub(named_keyword, line)
        out.append(line)
    return "\n".join(out) + "\n"


def title_of(text, fallback):
    found = re.search(r"^# (.+)$", text, re.M)
    return found.group(1).replace("`", "") if found else fallback


def navigation(folder, keywords):
    """The tree of the site as MkDocs reads it."""
    def pages(pattern, first=()):
        names = sorted(path.relative_to(folder).as_posix() for path in folder.glob(pattern))
        names = [*first, *(name for name in names if name not in first)]
        return [{title_of((folder / name).read_text(encoding="utf-8"), name): name}
                for name in names]

    groups = {}
    for keyword in keywords:
        groups.setdefault(keyword.group, []).append(
            {f"*{keyword.name}": f"keywords/{keyword.file}"})
    theory = [f"theory/{name}.md" for name in
              ("contact", "elements", "materials", "time_integration", "implicit", "rigid_bodies")]
    return [
        {"Start": ["index.md", {"Quick start": "quick_start.md"}, {"First steps": "first_steps.md"},
                   {"Tutorial": "tutorial.md"}, {"An answer with its error": "answer.md"}, {"Gallery": "gallery.md"},
                   {"Choose": "choose.md"},
                   {"Glossary": "glossary.md"}, {"Building": "building.md"}, {"Meshes": "meshes.md"},
                   {"Coming from LS-DYNA": "coming_from_ls_dyna.md"},
                   {"What was removed": "let_go.md"},
                   {"Results": "results.md"}, {"Messages": "messages.md"}, {"Python tools": "tools.md"}, {"Reliability": "reliability.md"},
                   {"Changelog": "changelog.md"}]},
        {"Keywords": ["keywords/index.md", {"All on one page": "keywords.md"},
                      {"Example decks": "examples/index.md"},
                      *({group: entries} for group, entries in groups.items())]},
        {"Theory": pages("theory/*.md", theory)},
        {"Verification": ["verification.md", {"Cases": pages("cases/*.md")}]},
        {"Studies": pages("studies/*.md", ["studies/index.md"])},
        {"Extend": [{"Contributing": "contributing.md"}, "architecture.md", "add_a_formulation.md", "add_a_law.md",
                    "add_a_material.md", "add_a_history.md",
                    {"Fortran interface": "fortran_interface.md"}]},
    ]


def make_settings(folder, keywords):
    """mkdocs.yml of the build; JSON is YAML too."""
    base = os.path.relpath(ROOT / "doc/mkdocs.yml", folder.parent)
    settings = {"INHERIT": base, "docs_dir": "pages", "site_dir": "../site",
                "nav": navigation(folder, keywords)}
    (folder.parent / "mkdocs.yml").write_text(json.dumps(settings, indent=1), encoding="utf-8")


def make(build):
    """All of the site's source below the folder `build`."""
    folder = build / "pages"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    pages = site_paths()
    text = (ROOT / "doc/keywords.md").read_text(encoding="utf-8")
    keywords = keyword_pages.write_pages(text, folder / "keywords")
    names = {keyword.name for keyword in keywords}
    made = [f"keywords/{keyword.file}" for keyword in keywords]
    sources = {**{page: (folder / page, "doc/keywords.md") for page in made},
               **{page: (ROOT / source, source) for source, page in pages.items()}}
    titles = {f"cases/{name}.md": f"# {name}: {case['title']}\n\n" for name, case in read_cases().items()}
    for page, (path, source) in sources.items():
        turned = turn_links(titles.get(page, "") + path.read_text(encoding="utf-8"), source if page not in made else
                            f"doc/{page}", page, {**pages, **{f"doc/{name}": name for name in
                                                  [*made, "keywords/index.md"]}}, names)
        (folder / page).parent.mkdir(parents=True, exist_ok=True)
        (folder / page).write_text(turned, encoding="utf-8")
    for case, report in read_reports(RESULTS).items():
        if (page := folder / "cases" / f"{case}.md").exists():
            page.write_text(page.read_text(encoding="utf-8") + all_checks(report), encoding="utf-8")
    with (folder / "messages.md").open("a", encoding="utf-8") as page:
        page.write(f"\n{messages.tables()}")
    (folder / "fortran_interface.md").write_text(FORTRAN, encoding="utf-8")
    shutil.copytree(ROOT / "doc/pictures", folder / "pictures")
    shutil.copy(ROOT / "doc/site.css", folder)
    make_settings(folder, keywords)


if __name__ == "__main__":
    make(pathlib.Path(sys.argv[1]).resolve())
