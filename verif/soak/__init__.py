# SPDX-License-Identifier: MIT
"""Soak tests: random scenes at full size."""
