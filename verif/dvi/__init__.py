# SPDX-License-Identifier: MIT
"""The DVI output of a board's simulated top."""
