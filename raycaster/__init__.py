# SPDX-License-Identifier: MIT
"""RayCaster: a real-time hardware ray tracer as a MyHDL library.

`raycaster.rtl` is the hardware, a room for each topic, and `raycaster.convert` makes Verilog of it. `raycaster.golden`
is the truth that the hardware is held against, `raycaster.verif` the benches that do so. `raycaster.fpga` has the ways
to boards, `raycaster.fit` what a scene can do without, `raycaster.sw` the software beside it, and `raycaster.cli` the
program `raycaster`. What all of them need (configuration, engines, screens, register map, scene files) is here.
"""
