# SPDX-License-Identifier: MIT
"""The C that drives the ray tracer, and what builds and plays it."""
