# SPDX-License-Identifier: MIT
"""Boards: what connects the ray tracer to a chip's pins, and the tools that make a configuration of it."""
