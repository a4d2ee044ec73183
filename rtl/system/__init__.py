# SPDX-License-Identifier: MIT
"""The top modules: the ray tracer alone, with a scene player, with a processor."""
