# SPDX-License-Identifier: MIT
"""Span engine: a row drawn as runs of columns of one colour."""
