# SPDX-License-Identifier: MIT
"""Proofs about the generated Verilog, which hold for every input, not only for those that a bench tries."""
