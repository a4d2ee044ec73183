# SPDX-License-Identifier: MIT
"""The truth in Python: what every picture must be, by rational arithmetic and as the seed engine rounds it."""
