# SPDX-License-Identifier: MIT
"""The manual: its pages, and the code that generates their diagrams and tables from the design."""
