# SPDX-License-Identifier: MIT
"""Mutation testing: recordings fit, and modules whose tests catch less than before are named."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from functools import partial
from typing import Any

import pytest
from conftest import refused

from raycaster.hdl.leaf import Leaf
from raycaster.hdl.signals import bit, reset_signal, unsigned
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import WORD_BITS
from raycaster.rtl.scene.scene_word import scene_word
from raycaster.verif.mutation.mutate import Leaf as LeafTest
from raycaster.verif.mutation.mutate import (
    MutationError,
    Recording,
    complaints,
    leaf_tests,
    leaves_of_modules,
    main,
    recordings,
)
from raycaster.verif.recording import record as record_run


def test_a_recording_that_does_not_fit_is_an_error(tmp_path):
    """A word is reset and then written in two cycles; the replay expects another last output."""
    ports: dict[str, Callable[[], Any]] = {"clk": bit, "reset": reset_signal, "selected": bit}
    ports["bus"] = partial(SceneBus, 7)
    ports |= dict.fromkeys(("implemented", "shadow", "live"), partial(unsigned, WORD_BITS))
    written = {"reset": 0, "selected": 1, "bus_write": 1, "bus_mask": 0xFFFF, "bus_data": 0x5A5A, "implemented": 0xFFF}
    stimulus = [{"reset": 1}, written, written]
    leaf = Leaf(scene_word, lambda: {name: make() for name, make in ports.items()}, tmp_path)
    expected = leaf.run_myhdl(stimulus)
    for wrong in (0, 1):
        expected[-1]["live"] ^= wrong
        record_run(leaf, tmp_path / "recording", stimulus, expected, settled=1)
        with pytest.raises(MutationError, match="without any fault") if wrong else nullcontext():
            Recording(tmp_path / "recording", tmp_path / "work").run(30, 1)


def test_complaints():
    """A module may catch a little less than before, but not much; a new one has no share to be compared with."""
    before = {"adder": [90, 10], "divider": [100, 0]}
    assert complaints({"adder": [88, 12], "divider": [97, 3], "new": [0, 10]}, before) == []
    assert complaints({"adder": [87, 13], "divider": [97, 3]}, before) == [
        "adder: 87.0% of the mutants are caught, 90.0% before"
    ]


def test_every_block_has_recordings():
    """Each block that is mutated has its test, with the given parameter sets."""
    known, tests = leaves_of_modules(), leaf_tests()
    assert {*recordings(known, tests).values()} == {*known}
    with pytest.raises(MutationError, match=r"divider: expected sets \['F9'\] of test_divider, got \[\]"):
        recordings({"divider": LeafTest("test_divider", ["F9"])}, tests)


def test_an_unknown_module_is_refused():
    assert "invalid choice: 'adder' (choose from 'apb_bridge'" in refused(main, "--module", "adder")
