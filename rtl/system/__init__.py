# SPDX-License-Identifier: MIT
"""The tops: the ray tracer alone, with a scene player, with a processor."""
