# SPDX-License-Identifier: MIT
"""From MyHDL to Verilog: one file a module, and what goes with them into other people's flows."""
