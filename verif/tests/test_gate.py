# SPDX-License-Identifier: MIT
"""The gate names the tests that it runs, and reports each fault that they notice no longer."""

from __future__ import annotations

import json

import pytest

from raycaster.verif import gate
from raycaster.verif.gate import FROZEN, LEAVES, TESTS, differences, lost

GONE = {"quick": {"it": "1"}, "slow": {}}


@pytest.mark.parametrize(
    ("before", "now", "expected"),
    [("111", "111", False), ("111", "11", True), ("1", "0", True), ("101 a", "110 a", True), ("101 a", "110 b", False),
     ("11 a", "110 b", True)],
)  # fmt: skip
def test_lost(before: str, now: str, expected: bool):
    """The same faults are compared one by one, and others by their share."""
    assert lost(before, now) == expected


def test_differences():
    """A fault that another set notices, or that has become slow, is named; a new one is no difference."""
    before = {"quick": {"one": "1", "two": "11", "three": "1"}, "slow": {"four": "1"}}
    now = {"quick": {"four": "1", "two": "1", "new": "1"}, "slow": {"one": "1"}}
    assert sorted(differences("test", before, now)) == [
        "test[one]: noticed by slow tests only",
        "test[three]: noticed before 1, now 0",
        "test[two]: noticed before 11, now 1",
    ]


@pytest.mark.slow
def test_a_fault_that_is_not_noticed_is_reported(tmp_path, monkeypatch, capsys):
    """The entry of a test that is gone is reported; that of a test with five faults is found as it was frozen."""
    known = "test_driver.py::test_a_fault_in_the_access_is_noticed"
    entries = {known: json.loads(FROZEN.read_text())[known], "test_driver.py::test_gone": {"by": "bus", **GONE}}
    monkeypatch.setattr(gate, "FROZEN", tmp_path / "gate.json")
    gate.FROZEN.write_text(json.dumps(entries))
    assert gate.main(["--jobs", "1", "--build", str(tmp_path)]) == 1
    assert "test_driver.py::test_gone[it]: noticed before 1, now 0" in capsys.readouterr().out.splitlines()


def test_each_entry_is_a_test():
    """A test that was renamed has its entry renamed too."""
    for entry in json.loads(FROZEN.read_text()):
        file, _, function = entry.partition("::")
        assert entry == LEAVES or f"def {function}(" in (TESTS / file).read_text(), entry
