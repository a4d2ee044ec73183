# SPDX-License-Identifier: MIT
"""The gate names the tests that it runs, and reports each fault that they notice no longer."""

from __future__ import annotations

import json

import pytest

from raycaster.verif import gate
from raycaster.verif.gate import FROZEN, LEAVES, TESTS


@pytest.mark.slow
def test_a_fault_that_is_not_noticed_is_reported(tmp_path, monkeypatch, capsys):
    """The entry of a test that is gone is reported; that of a test with five faults is found as it was frozen."""
    known = "test_driver.py::test_a_fault_in_the_access_is_noticed"
    entries = {
        known: json.loads(FROZEN.read_text())[known],
        "test_driver.py::test_gone": {"by": "bus", "quick": {"it": "1"}, "slow": {}},
    }
    monkeypatch.setattr(gate, "FROZEN", tmp_path / "gate.json")
    gate.FROZEN.write_text(json.dumps(entries))
    assert gate.main(["--jobs", "1", "--build", str(tmp_path)]) == 1
    assert "test_driver.py::test_gone[it]: noticed before 1, now 0" in capsys.readouterr().out.splitlines()


def test_each_entry_is_a_test():
    """A test that was renamed has its entry renamed too."""
    for entry in json.loads(FROZEN.read_text()):
        file, _, function = entry.partition("::")
        assert entry == LEAVES or f"def {function}(" in (TESTS / file).read_text(), entry
