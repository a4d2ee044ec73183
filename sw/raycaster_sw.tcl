# SPDX-License-Identifier: MIT
# The driver for the board support packages of Nios II (HAL), of the component in raycaster_hw.tcl. It has not been run
# in Quartus so far.

create_driver raycaster_driver

set_sw_property hw_class_name ray_caster_module
set_sw_property version 0.1
set_sw_property min_compatible_hw_version 0.1

# A program probes by itself, with the base address that system.h names.
set_sw_property auto_initialize false

set_sw_property bsp_subdirectory drivers

add_sw_property c_source raycaster.c
add_sw_property include_source raycaster.h
add_sw_property include_source raycaster_regs.h

add_sw_property supported_bsp_type HAL
add_sw_property supported_bsp_type UCOSII
