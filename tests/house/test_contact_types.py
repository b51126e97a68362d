# SPDX-License-Identifier: MIT
"""The tools, the studies and the tests run over the contact types that the program has."""
import re
import sys

from fortran_source import ROOT

sys.path.insert(0, str(ROOT / "tools"))
from slideline_tools import contact_types  # noqa: E402


def test_the_list_is_that_of_the_program():
    text = (ROOT / "src/contact/contact_dispatch.f90").read_text(encoding="utf-8")
    numbers = dict(re.findall(r"(type_\w+) = (\d+)", (ROOT / "src/model/contacts.f90").read_text(encoding="utf-8")))
    found = {int(numbers[name]): title
             for name, title in re.findall(r"contact_kind_t\((type_\w+), '([^']+)'", text)}
    assert found == contact_types.PROGRAM_NAMES
    assert contact_types.ALL_TYPES == tuple(contact_types.TYPES) == tuple(found)
