# SPDX-License-Identifier: MIT
"""Compiled benches that check the arithmetic with all operands, or with very many."""
