# SPDX-License-Identifier: MIT
"""The gate names the tests that it runs, and reports each fault that they notice no longer."""

from __future__ import annotations

import json

from raycaster.verif.gate import FROZEN, LEAVES, TESTS, differences


def test_a_fault_that_is_not_noticed_is_reported():
    """Fewer faults, another one of the same mutants, and a fault that only slow tests notice now."""
    before = {"quick": {"fewer": 2, "mutants": "0111 a", "slower": 1, "more": 1}, "slow": {"quicker": 1, "gone": 1}}
    now = {"quick": {"fewer": 1, "mutants": "1011 a", "quicker": 1, "more": 2}, "slow": {"slower": 1}}
    lines = differences("test", before, now)
    assert [line.partition("]")[0] for line in lines] == ["test[fewer", "test[mutants", "test[slower", "test[gone"]


def test_each_entry_is_a_test():
    """A test that was renamed has its entry renamed too."""
    for entry in json.loads(FROZEN.read_text()):
        file, _, function = entry.partition("::")
        assert entry == LEAVES or f"def {function}(" in (TESTS / file).read_text(), entry
