#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Translate a pFUnit test file (.pf) to a Fortran program, where pFUnit itself is not installed.

usage: pf2f90.py TEST.pf OUT.f90 [TEST.pf OUT.f90 ...]

Knows the part of pFUnit 4 that the tests of this project use and refuses the rest by name, with
file and line.  The rules of pFUnit's own preprocessor hold here too: the module has the name of the
file, a directive stands alone on one line, a test takes no arguments.
"""
import re
import sys
from pathlib import Path

#: assertion -> least number of arguments
ASSERTIONS = {
    "assertequal": 2, "asserttrue": 1, "assertfalse": 1, "assertlessthan": 2,
    "assertlessthanorequal": 2, "assertgreaterthan": 2, "assertgreaterthanorequal": 2,
    "assertrelativelyequal": 3, "assertisnan": 1, "assertisfinite": 1, "assertfail": 1,
}
#: names that `use funit` of pFUnit 4.14 brings along: no procedure or module of a test may have them
TAKEN = set("""
    abstractmatcher abstracttestparameter all_of allof any_of anyexceptions anyof
    array_with_size assert_that assertall assertany assertequal assertexceptionraised assertfail
    assertfalse assertgreaterthan assertgreaterthanorequal assertisfinite assertisnan
    assertlessthan assertlessthanorequal assertnone assertnotall assertnotequal
    assertrelativelyequal assertsameshape asserttrue basetestrunner catch catchnext
    contains_string debuglistener disable empty_array ends_with equal_to every every_item
    expectation false finalize generic_run get_context ignore_all ignore_differences initialize
    is isarraywithsize isequal isnear isnot isrelativelynear istrueorfalse keep_all
    listenerpointer loadtests_interface matchable matcherdescription namefilter near not
    output_unit parallelcontext parameterizedtestcase predicate relatively_near remoterunner
    resultprinter robustrunner run serialcontext set_command_line_options sourcelocation
    starts_with stringcontains stringdescription stringendswith stringstartswith stub subject
    taplistener test testannotation testcase testlistener testlistenervector testmethod
    testresult testrunner testsuite throw timeoutannotation trim_all true wascalled
    wascalledonce wasnotcalled whitespaceoptions xmlprinter
""".split())
DEFINED = re.compile(r"\s*(?:(?:pure|elemental|recursive|impure|module)\s+)*"
                     r"(?:subroutine|(?:[a-z][\w() ,=*:]*\s)?function|interface|type\s*(?:,[^:]*)?::|module)\s+(\w+)", re.I)
SUBROUTINE = re.compile(r"\s*subroutine\s+(\w+)\s*(?:\(([\w\s,]*)\))?\s*(?:!.*)?$", re.I)
MODULE = re.compile(r"\s*module\s+(?!procedure\b)(\w+)(.*)$", re.I)
DIRECTIVE = re.compile(r"\s*@(\w+)\s*(.*?)\s*$")


class Refused(Exception):
    """A line that cannot be translated."""


def split_arguments(text):
    """Split `a, f(b, c), 'x,y'` at the commas of the outer level."""
    parts, depth, quote, current = [], 0, "", ""
    for char in text:
        if quote:
            quote = "" if char == quote else quote
        elif char in "'\"":
            quote = char
        elif char in "([":
            depth += 1
        elif char in ")]":
            depth -= 1
            if depth < 0:
                return []
        elif char == "," and depth == 0:
            parts.append(current)
            current = ""
            continue
        current += char
    if quote or depth:
        return []
    return parts + [current] if current.strip() else parts


class Translator:
    """The state of one translation; `lines` is the Fortran text."""

    def __init__(self, path):
        self.path = path
        self.module = ""
        self.tests = []
        self.fixtures = {}
        self.expected = ""  # the directive whose subroutine comes next
        self.lines = []

    def translate(self, text):
        """Translate the whole file; raises Refused."""
        self.mark(1)
        for number, line in enumerate(text.splitlines(), 1):
            try:
                self.take(number, line)
            except Refused as trouble:
                raise Refused(f"{self.path}:{number}: {trouble}") from None
        if not self.module:
            raise Refused(f"{self.path}: no module in this file")
        if self.expected:
            raise Refused(f"{self.path}: @{self.expected} at the end, without a subroutine")
        if not self.tests:
            raise Refused(f"{self.path}: no @test in this file")
        self.add_program()
        return "\n".join(self.lines) + "\n"

    def mark(self, number):
        """Let the compiler speak of the line of the .pf file."""
        self.lines.append(f'# {number} "{self.path.name}"')

    def take(self, number, line):
        """Translate one line."""
        directive = DIRECTIVE.match(line)
        if directive:
            self.take_directive(number, directive.group(1), directive.group(2))
            return
        if line.strip() and not line.lstrip().startswith("!"):
            if self.expected:
                self.take_name(line)
            elif not self.module:
                self.take_module(line)
            self.check_names(line)
        self.lines.append(line)

    def check_names(self, line):
        """What the file defines must not have a name that pFUnit's own module has."""
        found = DEFINED.match(line)
        if found and not re.match(r"\s*end\b", line, re.I) and found.group(1).lower() in TAKEN:
            raise Refused(f"{found.group(1)} is a name of pFUnit's own module funit: give it another")

    def take_module(self, line):
        """The first statement of the file names the module."""
        found = MODULE.match(line)
        if not found:
            raise Refused("the first statement must be 'module NAME'")
        if found.group(2).strip():
            raise Refused("pFUnit wants nothing after 'module NAME' on its line")
        self.module = found.group(1)
        if self.module.lower() != self.path.stem.lower():
            raise Refused(f"module {self.module} must be named {self.path.stem}, as the file is")

    def take_name(self, line):
        """The subroutine that belongs to the directive before it."""
        found = SUBROUTINE.match(line)
        if not found:
            raise Refused(f"@{self.expected} must be followed by 'subroutine NAME()'")
        name, arguments = found.groups()
        if (arguments or "").strip():
            raise Refused(f"{name}: a test subroutine takes no arguments here")
        if self.expected == "test":
            if name.lower() in [test.lower() for test in self.tests]:
                raise Refused(f"test {name} occurs twice")
            self.tests.append(name)
        else:
            self.fixtures[self.expected] = name
        self.expected = ""

    def take_directive(self, number, name, rest):
        """A line that starts with @."""
        word = name.lower()
        if self.expected:
            raise Refused(f"@{name} where the subroutine of @{self.expected} should be")
        if word in ("test", "before", "after"):
            if rest:
                raise Refused(f"@{name}{rest}: only the plain @{word} is known here")
            if word in self.fixtures:
                raise Refused(f"a second @{word}")
            self.expected = word
            self.lines.append(f"!@{word}")
        elif word in ASSERTIONS:
            self.take_assertion(number, name, rest)
        else:
            raise Refused(f"@{name} is not known here")

    def take_assertion(self, number, name, rest):
        """An assertion: a call with its place, then out of the test if it failed."""
        inside = re.fullmatch(r"\((.*)\)", rest)
        if not inside:
            raise Refused(f"@{name} must be closed on its line, with nothing after it")
        arguments = split_arguments(inside.group(1))
        if len(arguments) < ASSERTIONS[name.lower()]:
            raise Refused(f"@{name} needs {ASSERTIONS[name.lower()]} arguments or more")
        self.mark(number)
        self.lines.append(f"  call {name}({inside.group(1)}, &")
        self.lines.append(f"    location=SourceLocation('{self.path.name}', {number}))")
        self.lines.append("  if (anyExceptions()) return")
        self.mark(number + 1)

    def add_program(self):
        """The main program: every test between its fixtures, then the count."""
        calls = []
        for test in self.tests:
            calls.append(f"  call begin_test('{test}')")
            if "before" in self.fixtures:
                calls.append(f"  call {self.fixtures['before']}()")
            calls.append(f"  if (.not. anyExceptions()) call {test}()")
            if "after" in self.fixtures:
                calls.append(f"  call {self.fixtures['after']}()")
            calls.append("  call end_test()")
        self.lines += ["", f"program run_{self.module}", "  use funit", f"  use {self.module}",
                       "  implicit none", *calls, "  call finish_tests()",
                       f"end program run_{self.module}"]


def main(arguments):
    if not arguments or len(arguments) % 2:
        sys.exit(__doc__)
    for source, target in zip(map(Path, arguments[::2]), map(Path, arguments[1::2])):
        try:
            text = Translator(source).translate(source.read_text(encoding="utf-8"))
        except Refused as trouble:
            sys.exit(str(trouble))
        # What is as it was is not compiled again.
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
