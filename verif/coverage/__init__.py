# SPDX-License-Identifier: MIT
"""How much of the hardware the checks reach."""
