# SPDX-License-Identifier: MIT
"""Modules, records and checks for MyHDL, usable without the ray tracer.

`records` has records and interfaces, `signals` signals of given widths and ties, `verbs` processes of one assignment,
and `given` existing Verilog.
`hierarchy` converts a design to Verilog with a file for each module: `contents` finds a module's signals, and
`verilog_style` prints it. `source` leaves out the branches that constants decide, `statements` prints processes,
`expressions` prints expressions by their types, or refuses them, and `leaf` runs the same inputs through MyHDL's
simulator and the converted Verilog.
"""
