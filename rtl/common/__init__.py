# SPDX-License-Identifier: MIT
"""Shared by all hardware folders: ports, records, widths, constants."""
