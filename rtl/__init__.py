# SPDX-License-Identifier: MIT
"""The hardware: one MyHDL block a file, named as in the hierarchy of the original design."""

if __name__ != "raycaster.rtl":
    raise ImportError(f"{__name__} is a part of raycaster; import raycaster.rtl")
