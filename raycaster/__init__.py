# SPDX-License-Identifier: MIT
"""RayCaster: a real-time hardware ray tracer as a MyHDL library.

`raycaster.rtl` is the hardware, `raycaster.golden` the truth that it is held against, `raycaster.verif` the benches
that do so; what all of them need (configuration, register map, scene files) is here.
"""
