# SPDX-License-Identifier: MIT
"""Culling of the rectangles that no primary ray of a group can hit."""
