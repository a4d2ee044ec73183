# SPDX-License-Identifier: MIT
"""Meanings of Python names in the hardware's docstrings and comments, for their Verilog."""

from collections.abc import Mapping
from typing import Any, get_args

from raycaster.design.decide import OPTIONS
from raycaster.rtl.bus.frame_check import CHECK_CYCLES
from raycaster.rtl.common import widths
from raycaster.rtl.cull.rect_setup import SETUP_LATENCY
from raycaster.rtl.span.run_memory import read_latency


def _option(name: str) -> str:
    """Return the option of `make` or `raycaster` for an attribute of the configuration that is true."""
    annotation = OPTIONS[name].annotation
    return f"{name.upper()}=1" if bool in (annotation, *get_args(annotation)) else name.upper()


VOCABULARY: Mapping[str, Any] = {
    # Widths, which a docstring may name even if the block's code does not use them.
    **vars(widths),
    # Latencies of other blocks.
    "CHECK_CYCLES": CHECK_CYCLES,
    "SETUP_LATENCY": SETUP_LATENCY,
    "read_latency": read_latency,
    # Choices that a text depends on.
    **{f"config.{name}": _option(name) for name in OPTIONS},
    "config.fixed": "FIX",
}
