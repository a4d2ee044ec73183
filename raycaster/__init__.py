# SPDX-License-Identifier: MIT
"""RayCaster: a real-time hardware ray tracer as a MyHDL library.

`raycaster.rtl` is the hardware, one folder per topic, and `raycaster.convert` converts it to Verilog, with
`raycaster.hdl`, which does so for any MyHDL design.
`raycaster.golden` has the golden models that the hardware is compared with, and `raycaster.verif` the test benches.
`raycaster.fpga` builds designs for boards, `raycaster.fit` leaves out hardware that a scene does not need,
`raycaster.sw` is the software, and `raycaster.cli` the program `raycaster`. `raycaster.design` decides a design from
options. Code that all of them share (configuration, screens, register map, scene files) is here.
"""
