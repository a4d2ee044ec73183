# SPDX-License-Identifier: MIT
"""Golden models in Python: every picture as it must be, in rational arithmetic or with the seed engine's rounding."""

if __name__ != "raycaster.golden":
    raise ImportError(f"{__name__} is a part of raycaster; import raycaster.golden")
