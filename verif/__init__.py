# SPDX-License-Identifier: MIT
"""Benches that hold the hardware against the golden models, and the commands that run them."""
