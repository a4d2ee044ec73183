# SPDX-License-Identifier: MIT
"""The registers, and the access to the scene memories."""

from myhdl import Signal, always_comb, always_seq, block, instances

from raycaster.configuration import FEATURES, Configuration
from raycaster.hdl.signals import bit, tied, unsigned
from raycaster.hdl.verbs import assign
from raycaster.registers import register_map
from raycaster.rtl.common.interfaces import SceneBus
from raycaster.rtl.common.widths import CYCLE_BITS, RGB_BITS, WORD_BITS
from raycaster.rtl.scene.scene_word import scene_word

FIXED_CODES = {"rects": 1, "all": 2}


def engine_word(config: Configuration) -> int:
    """Return the value of a design's engine register."""
    return register_map(*config.map)["engine"].pack(
        engine=config.facts.code,
        fraction_bits=config.fraction_bits,
        nearest=int(config.rounding == "nearest"),
        divider_bits=config.divider_bits,
        reflections=config.most_reflections,
        scale=config.scale,
        colour_bits=config.colour_bits,
        fixed=FIXED_CODES[config.fixed.scope] if config.fixed else 0,
        culling=int(config.culling),
        **{feature: int(getattr(config, feature)) for feature in FEATURES},
    )


def has_large_table(config: Configuration) -> bool:
    """Return True if the size register is too small for the number of rectangles, which is in the register `table`."""
    size = register_map(*config.map)["size"].fields["rectangles"]
    return config.table >= 1 << size.width


def version_word(config: Configuration) -> int:
    """Return the value of a design's version register. Only a large table is an addition to version 1.0."""
    return register_map(*config.map)["version"].reset | int(has_large_table(config))


def size_word(config: Configuration) -> int:
    """Return the value of a design's size register."""
    size = register_map(*config.map)["size"]
    most = (1 << size.fields["rectangles"].width) - 1
    return size.pack(units=config.units, rectangles=min(config.table, most), rows=config.rows)


def table_word(config: Configuration) -> int:
    """Return the value of a design's table register."""
    return register_map(*config.map)["table"].pack(rectangles=config.table if has_large_table(config) else 0)


@block
def avalon_interface(
    clk, reset, avs_s0, irq, bus: SceneBus, camera_readback, rect_readback, bad_rectangle, picture, progress,
    config: Configuration,
):  # fmt: skip
    """Hold the registers and give access to the scene memories, as an Avalon-MM agent.

    Words have 32 bits. A transfer takes one cycle, and an accepted read is answered with readdatavalid two cycles
    later. waitrequest is reset delayed by one cycle: in the first cycle of a reset it is still low, and a transfer
    accepted then is lost. Every other accepted read is answered once, in order. Writes pass through a register: they
    take effect in the cycle after they are accepted, before any later read is answered.

    Args:
        avs_s0: `AvalonPort`, this block as the agent: drives readdata, readdatavalid and waitrequest, reads the rest.
        irq: level; output, high while the StartScreen interrupt is pending and enabled.
        bus: `SceneBus`; output.
        camera_readback: unsigned, 32 bits; the camera memory's word at bus.address, read at the camera's addresses
            only. 0 if the camera is fixed.
        rect_readback: unsigned, 32 bits; the word at bus.address of the rectangle memory and of other registers outside
            of this block, 0 if there is none. Read in the cycle after bus.access.
        bad_rectangle: flag; the shadow holds an enabled rectangle without a plane. Read with bus.commit.
        picture: `Picture`; output. With a fixed camera only run is driven.
        progress: `Progress`; input.
    """
    live = not (config.fixed and config.fixed.camera)
    whole_frames = config.facts.whole_frames
    registers = register_map(*config.map)
    control, status, cycles = registers["control"], registers["status"], registers["cycles"]
    run_bit, commit_bit = control.fields["run"].lsb, control.fields["commit"].lsb
    reflections_low = control.fields["reflections"].lsb
    reflections_high = reflections_low + control.fields["reflections"].width
    most_reflections = config.most_reflections
    busy_bit, underrun_bit, bad_bit = (status.fields[name].lsb for name in ("busy", "underrun", "bad_rectangle"))
    frame_low = status.fields["frame"].lsb
    frame_bits = status.fields["frame"].width
    group_low = cycles.fields["group"].lsb
    irq_bit = registers["irq_pending"].fields["start_screen"].lsb

    in_order = (
        "id", "version", "engine", "size", "control", "status", "cycles", "irq_enable", "irq_pending", "background",
        "camera",
    )  # fmt: skip
    (
        id_address, version_address, engine_address, size_address, control_address, status_address, cycles_address,
        irq_enable_address, irq_pending_address, background_address, camera_address,
    ) = (bus.address_of(registers[name]) for name in in_order)  # fmt: skip
    id_value = tied(registers["id"].reset, WORD_BITS)
    version_value = tied(version_word(config), WORD_BITS)
    engine_value, size_value = tied(engine_word(config), WORD_BITS), tied(size_word(config), WORD_BITS)
    unkept = control.fields["commit"].mask | (0 if live else control.fields["reflections"].mask)
    control_bits = tied(control.implemented & ~unkept, WORD_BITS)
    background_bits = tied(registers["background"].implemented, WORD_BITS)
    control_word, live_control = unsigned(WORD_BITS), unsigned(WORD_BITS)
    background_word, live_background = unsigned(WORD_BITS) if live else tied(0, WORD_BITS), unsigned(WORD_BITS)
    select_control, select_background = bit(), bit()
    wait_request = Signal(bool(1))
    reading = bit()
    commit_pending = bit()
    written_ones = unsigned(WORD_BITS)
    read_data = unsigned(WORD_BITS)
    frame = unsigned(frame_bits)
    sticky_underrun, sticky_bad = bit(), bit()
    slowest_row, slowest_group = (tied(0, CYCLE_BITS) if whole_frames else unsigned(CYCLE_BITS) for _ in range(2))
    at_camera, at_light = bit(), bit() if config.light else tied(0, 1)
    irq_enable, irq_pending = bit(), bit()
    take_scene = progress.take_scene if whole_frames else progress.start_screen
    underrun = tied(0, 1) if whole_frames else progress.underrun
    elsewhere = rect_readback
    if has_large_table(config):
        elsewhere, at_table = unsigned(WORD_BITS), bit()
        table_address, table_value = bus.address_of(registers["table"]), tied(table_word(config), WORD_BITS)

        find_table = assign(at_table, lambda: bus.address == table_address)
        read_table = assign(elsewhere, lambda: table_value if at_table else rect_readback)

    control_memory = scene_word(
        clk, reset, bus, select_control, implemented=control_bits, shadow=control_word, live=live_control
    )

    @always_seq(clk.posedge, reset=reset)
    def become_ready():
        wait_request.next = False

    drive_ports = assign((avs_s0.waitrequest, irq), lambda: (wait_request, irq_pending and irq_enable))
    drive_bus = assign((bus.go_live, bus.next_address), lambda: (take_scene, avs_s0.address))
    see_access = assign(bus.access, lambda: (avs_s0.write or avs_s0.read) and not wait_request)
    drive_run = assign(picture.run, lambda: live_control[run_bit])

    # Byte enables become a mask of bits.
    @always_seq(clk.posedge, reset=reset)
    def accept():
        bus.write.next = avs_s0.write and not wait_request
        reading.next = avs_s0.read and not wait_request
        if bus.access:
            bus.address.next = bus.next_address
        if avs_s0.write and not wait_request:
            bus.data.next = avs_s0.writedata
            bus.mask.next = 0
            if avs_s0.byteenable[0]:
                bus.mask.next[8:0] = 0xFF
            if avs_s0.byteenable[1]:
                bus.mask.next[16:8] = 0xFF
            if avs_s0.byteenable[2]:
                bus.mask.next[24:16] = 0xFF
            if avs_s0.byteenable[3]:
                bus.mask.next[32:24] = 0xFF

    decode = assign((select_control, written_ones), lambda: (bus.address == control_address, bus.data & bus.mask))

    if config.light:
        light_address = bus.address_of(registers["light"])

        find_light = assign(at_light, lambda: bus.address == light_address)

    if config.turn:
        up_address = bus.address_of(registers["up"])

        # The camera's registers have consecutive addresses.
        find_camera = assign(at_camera, lambda: camera_address <= bus.address <= up_address)

    else:
        find_camera = assign(at_camera, lambda: bus.address == camera_address)

    # The shadow is copied in the cycle after the write that requests it.
    @always_seq(clk.posedge, reset=reset)
    def commit():
        bus.commit.next = bus.write and select_control and written_ones[commit_bit]
        if bus.commit:
            commit_pending.next = True
        elif take_scene:
            commit_pending.next = False

    # If a bit is set and cleared in the same cycle, it is set.
    @always_seq(clk.posedge, reset=reset)
    def keep_status():
        if bus.write and bus.address == status_address:
            if written_ones[underrun_bit]:
                sticky_underrun.next = False
            if written_ones[bad_bit]:
                sticky_bad.next = False
        if underrun:
            sticky_underrun.next = True
        if bus.commit and bad_rectangle:
            sticky_bad.next = True
        if progress.start_screen:
            frame.next = (frame + 1) % (1 << frame_bits)

    @always_seq(clk.posedge, reset=reset)
    def interrupt():
        if bus.write and bus.address == irq_enable_address and bus.mask[irq_bit]:
            irq_enable.next = bus.data[irq_bit]
        if bus.write and bus.address == irq_pending_address and written_ones[irq_bit]:
            irq_pending.next = False
        if progress.start_screen:
            irq_pending.next = True

    if not whole_frames:
        # The most cycles that a row and a group took since the last write to this register.
        @always_seq(clk.posedge, reset=reset)
        def keep_cycles():
            if bus.write and bus.address == cycles_address and bus.mask != 0:
                slowest_row.next = slowest_group.next = 0
            elif progress.busy:
                if progress.row_cycles > slowest_row:
                    slowest_row.next = progress.row_cycles
                if progress.group_cycles > slowest_group:
                    slowest_group.next = progress.group_cycles

    @always_comb
    def read():
        read_data.next = elsewhere
        if bus.address == id_address:
            read_data.next = id_value
        elif bus.address == version_address:
            read_data.next = version_value
        elif bus.address == engine_address:
            read_data.next = engine_value
        elif bus.address == size_address:
            read_data.next = size_value
        elif bus.address == control_address:
            read_data.next = control_word
            read_data.next[commit_bit] = commit_pending or bus.commit
        elif bus.address == status_address:
            read_data.next = 0
            read_data.next[busy_bit] = progress.busy
            read_data.next[underrun_bit] = sticky_underrun
            read_data.next[bad_bit] = sticky_bad
            read_data.next[frame_low + frame_bits : frame_low] = frame
        elif bus.address == cycles_address:
            read_data.next[CYCLE_BITS:] = slowest_row
            read_data.next[group_low + CYCLE_BITS : group_low] = slowest_group
        elif bus.address == irq_enable_address:
            read_data.next = 0
            read_data.next[irq_bit] = irq_enable
        elif bus.address == irq_pending_address:
            read_data.next = 0
            read_data.next[irq_bit] = irq_pending
        elif bus.address == background_address:
            read_data.next = background_word
        elif at_camera or at_light:
            read_data.next = camera_readback

    @always_seq(clk.posedge, reset=reset)
    def answer():
        avs_s0.readdatavalid.next = reading
        if reading:
            avs_s0.readdata.next = read_data

    if live:
        background_memory = scene_word(
            clk, reset, bus, select_background, implemented=background_bits, shadow=background_word,
            live=live_background,
        )  # fmt: skip

        decode_background = assign(select_background, lambda: bus.address == background_address)

        drive_background = assign(picture.background, lambda: live_background[RGB_BITS:])

        # More reflections than the design has count as all of them.
        asked = live_control(reflections_high, reflections_low)
        limit = assign(picture.reflections, lambda: most_reflections if asked > most_reflections else asked)

    return instances()
