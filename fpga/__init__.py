# SPDX-License-Identifier: MIT
"""Boards: Verilog between the ray tracer and a chip's pins, and the tools that make bitstreams and count cells."""
