# SPDX-License-Identifier: MIT
# The ray tracer with a Nios II/e, memory, buttons and a serial port over JTAG, for Intel's Platform Designer (Quartus
# 14.0 to 23.1), which writes nios_system.qsys. Not yet run there; docs/boards.md says what was tested.
#
# Run it in the directory that `make verilog` wrote, where Platform Designer looks for the component raycaster_hw.tcl:
#   qsys-script --script=nios_system.tcl --cmd="set family {MAX 10}; set device 10M50DAF484C7G"
#
# clock_hz is the frequency of the system's clock; the span engine needs its pixel clock. Software finds all addresses by
# the names in the system.h of its board support package; the driver's raycaster_sw.tcl is in sw/.

package require -exact qsys 14.0

# What --cmd does not set is that of a DE2-115.
foreach {name value} {family {Cyclone IV E} device EP4CE115F29C7 clock_hz 50000000} {
    if {![info exists $name]} {
        set $name $value
    }
}

create_system nios_system
set_project_property DEVICE_FAMILY $family
set_project_property DEVICE $device

foreach {name component} {
    clock clock_source
    cpu altera_nios2_gen2
    memory altera_avalon_onchip_memory2
    raycaster ray_caster_module
    buttons altera_avalon_pio
    serial altera_avalon_jtag_uart
} {
    add_instance $name $component
}

# The program starts in the memory, and so do exception handlers.
foreach {name parameter value} [list \
    clock clockFrequency $clock_hz  clock resetSynchronousEdges DEASSERT \
    cpu impl Tiny  cpu resetSlave memory.s1  cpu exceptionSlave memory.s1 \
    memory memorySize 65536  memory dataWidth 32  buttons direction Input  buttons width 5 \
] {
    set_instance_parameter_value $name $parameter $value
}

foreach {clocked reset} {
    cpu.clk cpu.reset memory.clk1 memory.reset1 raycaster.clock raycaster.reset buttons.clk buttons.reset serial.clk
    serial.reset
} {
    add_connection clock.clk $clocked
    add_connection clock.clk_reset $reset
}

# The frame interrupt has number 0.
foreach {from to parameter value} {
    cpu.instruction_master memory.s1 baseAddress 0x00000000
    cpu.instruction_master cpu.debug_mem_slave baseAddress 0x00020800
    cpu.data_master memory.s1 baseAddress 0x00000000
    cpu.data_master cpu.debug_mem_slave baseAddress 0x00020800
    cpu.data_master raycaster.s0 baseAddress 0x00040000
    cpu.data_master buttons.s1 baseAddress 0x00041000
    cpu.data_master serial.avalon_jtag_slave baseAddress 0x00041010
    cpu.irq raycaster.irq irqNumber 0
    cpu.irq serial.irq irqNumber 1
} {
    add_connection $from $to
    set_connection_parameter_value $from/$to $parameter $value
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
