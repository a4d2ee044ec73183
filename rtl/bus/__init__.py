# SPDX-License-Identifier: MIT
"""Avalon-MM, and what answers a processor."""
