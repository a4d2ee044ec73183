# SPDX-License-Identifier: MIT
"""A design chosen: the options, what is decided from them, and the hardware for a scene."""
