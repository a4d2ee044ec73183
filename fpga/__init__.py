# SPDX-License-Identifier: MIT
"""Boards: Verilog between the ray tracer and a chip's pins, and the tools that make bitstreams and count cells."""

if __name__ != "raycaster.fpga":
    raise ImportError(f"{__name__} is a part of raycaster; import raycaster.fpga")
