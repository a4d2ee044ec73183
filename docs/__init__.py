# SPDX-License-Identifier: MIT
"""The documentation: its pages, and what draws their pictures and counts their numbers from the design itself."""
