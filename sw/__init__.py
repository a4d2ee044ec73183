# SPDX-License-Identifier: MIT
"""The ray tracer's C driver and game, and the tools that build and play them."""
