# SPDX-License-Identifier: MIT
"""Man pages, completion and syntax files, made of `--help` and of the keyword tables of the reader.

    share.py PROGRAM FOLDER    writes them below FOLDER/share, where an installation has them
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tools/docs")]
import keyword_pages
from slideline_tools import __version__, cli

#: values of words of the command line that the help leaves to the keyword page
VALUES = {"ctype": range(8), "punit": range(5), "timing": ("phase", "interface", "off"), "quiet": "1", "d": ("nodump",)}
#: words that take a path, and the endings of these files
PATHS = {"i": ("k", "key", "dyn"), "r": ("h5",), "d": ()}


def words(text):
    """The words `name=` of a help text, in its order, and those with dashes."""
    found = re.findall(r"(?<![\w.:])([a-z0-9]+)=[A-Z1-9.]", text) + ["memory", "memory2"]
    return [f"{name}=" for name in dict.fromkeys(found)] + ["check", "--json", "--help", "--version"]


# ---- man pages ---------------------------------------------------------------------------------
def escaped(line):
    """A line of text for roff."""
    line = line.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + line if line.startswith(".") else line


def man_page(name, summary, sections):
    """The source of a man page; a section is (heading, text), whose lines are kept."""
    lines = [f'.TH {name.upper()} 1 "" "slideline {__version__}" "User Commands"', ".SH NAME",
             escaped(f"{name} - {summary}")]
    for heading, text in sections:
        lines += [f".SH {heading}", ".nf", *map(escaped, text.rstrip("\n").split("\n")), ".fi"]
    return "\n".join(lines) + "\n"


def program_page(text):
    """The man page of the program from its help: a paragraph that begins with a word and a colon is a section."""
    title, synopsis, options, overrides, rest = text.split("\n\n", 4)
    results, more = rest.split("while it runs:", 1)
    running, status = more.split("exit status:", 1)
    status, version = status.rsplit("--version", 1)
    return man_page("slideline", title.partition(": ")[2], [
        ("SYNOPSIS", re.sub(r"^(usage:|      )  ?", "", synopsis, flags=re.M)),
        ("OPTIONS", f"{options}\n  --version     {version.replace('prints', '').strip()}"),
        ("OVERRIDES", overrides.partition("\n")[2]),
        ("FILES", results.partition(": ")[2]), ("WHILE IT RUNS", running.strip()),
        ("EXIT STATUS", status.strip()), ("SEE ALSO", "slideline-tools(1)")])


def tools_page():
    """The man page of the Python tools from their parsers."""
    parser = cli.build_parser()
    sections = [("SYNOPSIS", parser.format_usage().partition("usage: ")[2]), ("DESCRIPTION", parser.description)]
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            sections += [(name.upper(), one.format_help()) for name, one in action.choices.items()]
    sections += [("NOTES", parser.epilog), ("SEE ALSO", "slideline(1)")]
    return man_page("slideline-tools", "look into, draw and compare results of slideline", sections)


# ---- completion --------------------------------------------------------------------------------
#: names of the *PARAMETER cards of the deck on the command line, for all shells
NAMES = r"""awk 'toupper($0) ~ /^\*/ {on = toupper($1) ~ /^\*PARAMETER/; next} on && !/^\$/ {
  n = split($0, part, ","); if (n == 1) {n = 0; for (i = 1; i <= 71; i += 20) part[++n] = substr($0, i, 10)}
  for (i = 1; i <= n; i += (index($0, ",") ? 2 : 1)) {sub(/^ *[RrIiCc] */, "", part[i]); gsub(/ /, "", part[i])
    if (part[i] != "") print "p:" tolower(part[i]) "="}}'"""

BASH = """\
# completion of slideline for bash
_slideline() {{
  local line=${{COMP_LINE:0:COMP_POINT}} word start deck one
  word=${{line##* }}
  # Bash gives back only what follows the last = or :
  start=${{word%"${{word##*[=:]}}"}}
  case $word in
{cases}
  p:*)
    for one in $line; do
      case $one in i=*) deck=${{one#i=}} ;; *.k | *.key) deck=$one ;; esac
    done
    [ -r "$deck" ] && COMPREPLY=($(compgen -W "$({names} "$deck")" -- "$word"))
    ;;
  *) COMPREPLY=($(compgen -W "{words} p:" -- "$word") $(compgen -f -X '!*.@(k|key|dyn)' -- "$word") $(compgen -d -- "$word")) ;;
  esac
  COMPREPLY=("${{COMPREPLY[@]#"$start"}}")
  [[ ${{COMPREPLY[0]-}} == *[=:/] ]] && compopt -o nospace
}}
shopt -s extglob
complete -o filenames -F _slideline slideline
"""


def bash(text):
    """The script for bash."""
    cases = []
    for name, values in VALUES.items():
        if name not in PATHS:
            cases.append(f'  {name}=*) COMPREPLY=($(compgen -W "{" ".join(f"{name}={v}" for v in values)}" -- "$word")) ;;')
    for name, endings in PATHS.items():
        files = f"$(compgen -f -X '!*.@({'|'.join(endings)})' -- \"${{word#{name}=}}\") " if endings else ""
        cases.append(f'  {name}=*) COMPREPLY=({files}$(compgen -d -S / -- "${{word#{name}=}}"))\n    start= ;;')
    return BASH.format(cases="\n".join(cases), names=NAMES, words=" ".join(words(text)))


ZSH = """\
#compdef slideline
# completion of slideline for zsh
local deck one
case $PREFIX in
{cases}
p:*)
  for one in $words; do
    case $one in i=*) deck=${{one#i=}} ;; *.k | *.key) deck=$one ;; esac
  done
  [[ -r $deck ]] && compadd -S '' -- ${{(f)"$({names} $deck)"}}
  ;;
*)
  compadd -S '' -- {open} p:
  compadd -- {closed}
  _files -g '*.(k|key|dyn)'
  ;;
esac
"""


def zsh(text):
    """The script for zsh."""
    cases = [f"{name}=*) compset -P '*=' && compadd -- {' '.join(map(str, values))} ;;"
             for name, values in VALUES.items() if name not in PATHS]
    for name, endings in PATHS.items():
        how = f"-g '*.({'|'.join(endings)})'" if endings else "-/"
        cases.append(f"{name}=*) compset -P '*=' && _files {how} ;;")
    every = words(text)
    return ZSH.format(cases="\n".join(cases), names=NAMES, open=" ".join(w for w in every if w.endswith("=")),
                      closed=" ".join(w for w in every if not w.endswith("=")))


def fish(text):
    """The script for fish."""
    lines = ["# completion of slideline for fish", "complete -c slideline -f",
             "complete -c slideline -a '(__fish_complete_suffix .k .key)'",
             f"complete -c slideline -a '{' '.join(words(text))}'"]
    for name, values in VALUES.items():
        lines.append(f"complete -c slideline -a '{' '.join(f'{name}={value}' for value in values)}'")
    for name, endings in PATHS.items():
        files = " ".join(f"$start*.{ending}" for ending in endings)
        lines.append(f"complete -c slideline -n 'string match -q \"{name}=*\" -- (commandline -ct)' -a '(set start (string "
                     f"replace {name}= \"\" (commandline -ct)); for file in {files} $start*/; echo {name}=$file; end)'")
    return "\n".join(lines) + "\n"


#: what loads the tools' own completion (shtab's, which need not be there when a package is made) when it is first asked for
TOOLS_BASH = """\
# completion of slideline-tools for bash
eval "$(slideline-tools completion bash 2>/dev/null)"
"""
TOOLS_ZSH = """\
#compdef slideline-tools
eval "$(slideline-tools completion zsh 2>/dev/null)"
(( $+functions[_shtab_slideline_tools] )) && _shtab_slideline_tools "$@"
"""


def tools_fish():
    """The script for fish of the tools, which shtab does not write."""
    lines = ["# completion of slideline-tools for fish"]
    parser = cli.build_parser()
    subparsers = next(a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    for choice, help_of in zip(subparsers.choices, subparsers._choices_actions):
        lines.append(f"complete -c slideline-tools -n __fish_use_subcommand -a {choice} -d {json.dumps(help_of.help)}")
        for action in subparsers.choices[choice]._actions:
            for option in (o for o in action.option_strings if o.startswith("--")):
                lines.append(f"complete -c slideline-tools -n '__fish_seen_subcommand_from {choice}' -l {option[2:]}")
    return "\n".join(lines) + "\n"


# ---- syntax files ------------------------------------------------------------------------------
def keywords():
    """The honoured keywords, longest first."""
    return sorted(keyword_pages.read_schema(), key=lambda name: (-len(name), name))


def vim():
    """A syntax file of vim: keywords the reader knows, those it does not, comments, numbers, parameters."""
    known = "\\|".join(keywords())
    return f"""\
" syntax of decks of slideline
if exists("b:current_syntax") | finish | endif
syntax case ignore
syntax match slidelineUnknown /^\\*\\S.*$/
syntax match slidelineKeyword /^\\*\\({known}\\)\\(_TITLE\\|_ID\\)\\?\\s*$/
syntax match slidelineKeyword /^\\*\\(END\\|KEYWORD.*\\|TITLE\\)\\s*$/
syntax match slidelineComment /^\\$.*$/
syntax match slidelineParameter /&-\\?\\h\\w*/
syntax match slidelineNumber /[-+]\\?\\(\\d\\+\\.\\?\\d*\\|\\.\\d\\+\\)\\([ed][-+]\\?\\d\\+\\)\\?/
highlight default link slidelineUnknown Error
highlight default link slidelineKeyword Statement
highlight default link slidelineComment Comment
highlight default link slidelineParameter Identifier
highlight default link slidelineNumber Number
let b:current_syntax = "slideline"
"""


def grammar():
    """A TextMate grammar of the same, for VS Code and others."""
    names = "|".join(keywords())
    patterns = [("comment.line.dollar", r"^\$.*$"),
                ("keyword.control", rf"(?i)^\*({names}|END|KEYWORD.*|TITLE)(_TITLE|_ID)?\s*$"),
                ("invalid.illegal", r"^\*\S.*$"), ("variable.parameter", r"&-?[A-Za-z_]\w*"),
                ("constant.numeric", r"[-+]?(\d+\.?\d*|\.\d+)([eEdD][-+]?\d+)?")]
    return json.dumps({"name": "slideline deck", "scopeName": "source.slideline", "fileTypes": ["k", "key", "dyn"],
                       "patterns": [{"name": f"{name}.slideline", "match": match} for name, match in patterns]}, indent=1)


def extension():
    """The manifest that makes the grammar an extension of VS Code."""
    return json.dumps({"name": "slideline", "displayName": "slideline decks", "version": __version__, "publisher": "slideline",
                       "engines": {"vscode": "^1.60.0"}, "license": "MIT",
                       "contributes": {
                           "languages": [{"id": "slideline", "extensions": [".k", ".key", ".dyn"]}],
                           "grammars": [{"language": "slideline", "scopeName": "source.slideline",
                                         "path": "./slideline.tmLanguage.json"}]}}, indent=1)


def write(folder, name, text):
    """Write a file below `folder`, with the folders above it."""
    path = pathlib.Path(folder, "share", name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def main(program, folder):
    """Write all files."""
    text = subprocess.run([program, "--help"], check=True, capture_output=True, text=True).stdout
    write(folder, "man/man1/slideline.1", program_page(text))
    os.environ["COLUMNS"] = "80"
    write(folder, "man/man1/slideline-tools.1", tools_page())
    write(folder, "bash-completion/completions/slideline", bash(text))
    write(folder, "zsh/site-functions/_slideline", zsh(text))
    write(folder, "fish/vendor_completions.d/slideline.fish", fish(text))
    write(folder, "bash-completion/completions/slideline-tools", TOOLS_BASH)
    write(folder, "zsh/site-functions/_slideline-tools", TOOLS_ZSH)
    write(folder, "fish/vendor_completions.d/slideline-tools.fish", tools_fish())
    write(folder, "vim/vimfiles/syntax/slideline.vim", vim())
    write(folder, "vim/vimfiles/ftdetect/slideline.vim", "autocmd BufRead,BufNewFile *.k,*.key,*.dyn setfiletype slideline\n")
    write(folder, "slideline/vscode/slideline.tmLanguage.json", grammar())
    write(folder, "slideline/vscode/package.json", extension())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
