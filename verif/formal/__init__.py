# SPDX-License-Identifier: MIT
"""Proofs about the generated Verilog: what holds for every input, and not only for those that a bench thinks of."""
