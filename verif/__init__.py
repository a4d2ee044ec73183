# SPDX-License-Identifier: MIT
"""Benches that compare the hardware with the golden models, and the commands that run them."""
