# SPDX-License-Identifier: MIT
"""Golden models in Python: every picture as it must be, in rational arithmetic or with the seed engine's rounding."""
