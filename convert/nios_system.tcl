# SPDX-License-Identifier: MIT
# The ray tracer with a Nios processor, memory, buttons and a serial port over JTAG, for Intel's Platform Designer,
# which writes nios_system.qsys. Not yet run there; docs/boards.md says what was tested.
#
# Run it in the directory that `make verilog` wrote, where Platform Designer looks for the component raycaster_hw.tcl:
#   qsys-script --script=nios_system.tcl \
#       --cmd="set processor nios2; set family {Cyclone IV E}; set device EP4CE115F29C7"
#
# processor: nios2 (Nios II/e, Quartus 14.0 to 23.1) or niosv (Nios V/m, from 23.1 on; it needs a free licence).
# clock_hz: frequency of the system's clock, 50 MHz if not set; the beam engine needs its pixel clock. Software finds
# all addresses by the names in the system.h of its board support package; the driver's raycaster_sw.tcl is in sw/.

package require -exact qsys 14.0

if {![info exists clock_hz]} {
    set clock_hz 50000000
}
foreach needed {processor family device} {
    if {![info exists $needed]} {
        error "$needed is not set; see the head of nios_system.tcl"
    }
}

# For each processor: the component, its interfaces for instructions, data, debugging and interrupts, and agents that
# only the data interface reaches.
switch $processor {
    nios2 {
        set component altera_nios2_gen2
        lassign {instruction_master data_master debug_mem_slave irq} instructions data debug interrupts
        set own {}
        set debug_base 0x00020800
    }
    niosv {
        set component intel_niosv_m
        lassign {instruction_manager data_manager dm_agent platform_irq_rx} instructions data debug interrupts
        set own {timer_sw_agent 0x00020000}
        set debug_base 0x00030000
    }
    default {
        error "processor: expected nios2 or niosv, got $processor"
    }
}

create_system nios_system
set_project_property DEVICE_FAMILY $family
set_project_property DEVICE $device

add_instance clock clock_source
set_instance_parameter_value clock clockFrequency $clock_hz
set_instance_parameter_value clock resetSynchronousEdges DEASSERT

add_instance cpu $component
add_instance memory altera_avalon_onchip_memory2
set_instance_parameter_value memory memorySize 65536
set_instance_parameter_value memory dataWidth 32
add_instance raycaster ray_caster_module
add_instance buttons altera_avalon_pio
set_instance_parameter_value buttons direction Input
set_instance_parameter_value buttons width 5
add_instance serial altera_avalon_jtag_uart

foreach {clocked reset} {
    cpu.clk cpu.reset memory.clk1 memory.reset1 raycaster.clock raycaster.reset buttons.clk buttons.reset serial.clk
    serial.reset
} {
    add_connection clock.clk $clocked
    add_connection clock.clk_reset $reset
}

proc connect {from to base} {
    add_connection $from $to
    set_connection_parameter_value $from/$to baseAddress $base
}

connect cpu.$instructions memory.s1 0x00000000
connect cpu.$instructions cpu.$debug $debug_base
connect cpu.$data memory.s1 0x00000000
connect cpu.$data cpu.$debug $debug_base
foreach {end base} $own {
    connect cpu.$data cpu.$end $base
}
connect cpu.$data raycaster.s0 0x00040000
connect cpu.$data buttons.s1 0x00041000
connect cpu.$data serial.avalon_jtag_slave 0x00041010

# The frame interrupt has number 0.
set number 0
foreach sender {raycaster.irq serial.irq} {
    add_connection cpu.$interrupts $sender
    set_connection_parameter_value cpu.$interrupts/$sender irqNumber $number
    incr number
}

# The program starts in the memory, and so do exception handlers.
if {$processor eq "nios2"} {
    set_instance_parameter_value cpu impl Tiny
    set_instance_parameter_value cpu resetSlave memory.s1
    set_instance_parameter_value cpu exceptionSlave memory.s1
} else {
    set_instance_parameter_value cpu enableAvalonInterface true
    set_instance_parameter_value cpu resetSlave Absolute
    set_instance_parameter_value cpu resetOffset 0x00000000
}

foreach {name kind direction end} {
    clk clock sink clock.clk_in
    reset reset sink clock.clk_in_reset
    vga conduit end raycaster.vga
    buttons conduit end buttons.external_connection
} {
    add_interface $name $kind $direction
    set_interface_property $name EXPORT_OF $end
}

save_system nios_system.qsys
