# SPDX-License-Identifier: MIT
"""Memories of the scene: shadow, pending and live words, and the rectangles in the form that engines read."""
