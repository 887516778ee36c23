# SPDX-License-Identifier: GPL-3.0-or-later
"""The mark `grid`: the default run takes a part of the cases, and every function has one."""

import pytest
from etalon.tests.conftest import pytest_collection_modifyitems


class Case:
    """What the hook asks of a test."""

    def __init__(self, nodeid, one_in=None):
        self.nodeid, self.marks = nodeid, {} if one_in is None else {"grid": pytest.mark.grid(one_in).mark}

    def get_closest_marker(self, name):
        return self.marks.get(name)

    def add_marker(self, mark):
        self.marks[mark.name] = mark


@pytest.mark.parametrize(("size", "one_in", "taken"), [(30, 3, 10), (31, 3, 11), (2, 3, 1), (1, 3, 1), (5, 1, 5)])
def test_the_default_run_takes_one_in_so_many_cases(size, one_in, taken):
    cases = [Case(f"tests/test_a.py::test_one[{k}]", one_in) for k in range(size)]
    others = [Case(f"tests/test_a.py::test_two[{k}]") for k in range(4)]
    pytest_collection_modifyitems([*others, *cases])
    assert sum("slow" not in case.marks for case in cases) == taken
    assert not any("slow" in case.marks for case in others)
    again = [Case(case.nodeid, one_in) for case in reversed(cases)]
    pytest_collection_modifyitems(again)  # the order in which they are found does not matter
    assert {case.nodeid for case in again if "slow" in case.marks} == {c.nodeid for c in cases if "slow" in c.marks}
