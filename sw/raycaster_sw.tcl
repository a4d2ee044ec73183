# SPDX-License-Identifier: MIT
# Driver of the component in raycaster_hw.tcl, for Nios II board support packages (HAL). It has not been run in Quartus
# so far.

create_driver raycaster_driver

set_sw_property hw_class_name ray_caster_module
set_sw_property version 1.0.0
set_sw_property min_compatible_hw_version 1.0

# A program calls raycaster_probe itself, with the base address from system.h.
set_sw_property auto_initialize false

set_sw_property bsp_subdirectory drivers

add_sw_property c_source raycaster.c
add_sw_property include_source raycaster.h
add_sw_property include_source raycaster_regs.h

add_sw_property supported_bsp_type HAL
add_sw_property supported_bsp_type UCOSII
