# SPDX-License-Identifier: MIT
"""The hardware: one MyHDL block a file, named as in the hierarchy of the original design."""
