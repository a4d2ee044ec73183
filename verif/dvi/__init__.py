# SPDX-License-Identifier: MIT
"""The video output of a board's simulated top."""
