# SPDX-License-Identifier: MIT
"""A page in which the simulated hardware runs in a browser."""
