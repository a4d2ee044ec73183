# SPDX-License-Identifier: MIT
"""Convert MyHDL to Verilog, one file per module, with the files that other people's flows need."""
