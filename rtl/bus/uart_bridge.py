# SPDX-License-Identifier: MIT
"""A bridge from a serial port to an Avalon-MM agent."""

from myhdl import Signal, always_seq, block, enum, instances

from raycaster.configuration import Configuration
from raycaster.hdl.signals import bit, bits_for, unsigned
from raycaster.hdl.verbs import assign
from raycaster.registers import register_map
from raycaster.rtl.bus.frame_reader import frame_reader
from raycaster.rtl.bus.frame_writer import frame_writer
from raycaster.rtl.bus.uart_receiver import uart_receiver
from raycaster.rtl.bus.uart_transmitter import DATA_BITS, uart_transmitter
from raycaster.rtl.common.interfaces import BusPort
from raycaster.rtl.common.widths import LANES, WORD_BITS
from raycaster.serial_frames import ADDRESS_BITS, COUNT_BITS, WRITE_BIT


class UartPort(BusPort):
    """A serial port: 8 data bits, no parity, one stop bit.

    Attributes:
        rx: to this block; it may change at any time.
        tx: from this block; high while nothing is sent.
    """

    outputs = ("tx",)

    def __init__(self, address_bits: int):
        self.rx, self.tx = bit(), bit()


def longest_frame(config: Configuration) -> int:
    """Return the words of a frame that writes a whole scene and commits it, the check included.

    Two accesses do so: one of all words from the background's on, and one of the word that commits.
    """
    registers = register_map(*config.map)
    scene = [one.address for name, one in registers.items() if not name.startswith("frames.")]
    return max(scene) - registers["background"].address + 1 + 1 + 2 + 1


BridgeState = enum("IDLE", "FETCH", "STEP", "REPLY", "SEND", "READ", "AWAIT")


@block
def uart_bridge(clk, reset, uart, avm_m0, clock_hz: int, baud: int, places: int):
    """Bridge frames on a serial line to an Avalon-MM agent: each word of a frame becomes one transfer.

    A frame has any number of accesses one after the other. The first word of an access has the word address in bits
    15:0, the number of words in bits 25:16, and in bit 31 a 1 for a write, whose words follow. A read ends its frame.
    Nothing reaches the agent until the whole frame has come and its check is right. Then all words are written, in two
    cycles each; then the answer is sent, a frame with the first word of the last access, and the words that it reads.
    A frame that ends while an answer is sent is carried out at once, and the answer ends without its check. The agent
    must hold readdata until its next answer.

    Args:
        clk: the clock, `clock_hz` Hz.
        uart: `UartPort`, of this block: drives tx, reads rx.
        avm_m0: `AvalonPort`, this block as the host: reads readdata, readdatavalid and waitrequest, drives the rest.
        clock_hz: frequency of the clock.
        baud: bits per second.
        places: most words of a frame, the check included.
    """
    every_lane = (1 << LANES) - 1
    address_bits = len(avm_m0.address)
    last_address = (1 << address_bits) - 1
    count_low, count_high = ADDRESS_BITS, ADDRESS_BITS + COUNT_BITS

    state = Signal(BridgeState.IDLE)
    heard, sent = unsigned(DATA_BITS), unsigned(DATA_BITS)
    words, stop, place = (unsigned(bits_for(places)) for _ in range(3))
    shown, head, answer = (unsigned(WORD_BITS) for _ in range(3))
    address, next_address, left = unsigned(address_bits), unsigned(address_bits), unsigned(COUNT_BITS)
    received, good, start, offering, offered, sending, accepted = (bit() for _ in range(7))
    waiting, take, at_stop, stepping, writing, headless, at_head, last = (bit() for _ in range(8))

    receiver = uart_receiver(clk, reset, uart_rx=uart.rx, received=received, data=heard, clock_hz=clock_hz, baud=baud)
    reader = frame_reader(
        clk, reset, received=received, data=heard, good=good, words=words, place=place, shown=shown, places=places
    )
    writer = frame_writer(
        clk, reset, start=start, valid=offering, word=answer, last=last, ready=offered, sending=sending, data=sent,
        accepted=accepted,
    )  # fmt: skip
    transmitter = uart_transmitter(
        clk, reset, valid=sending, data=sent, ready=accepted, uart_tx=uart.tx, clock_hz=clock_hz, baud=baud
    )

    see_state = assign(
        (stepping, start, offering, at_stop),
        lambda: (state == BridgeState.STEP, state == BridgeState.REPLY, state == BridgeState.SEND, place == stop),
    )

    # A frame waits while another one's words are written. That takes less time than its own next words need to come.
    decide_take = assign(take, lambda: waiting and (offering or state == BridgeState.IDLE))
    decide_writing = assign(writing, lambda: stepping and left != 0 and not at_stop)
    decide_last = assign(last, lambda: head[WRITE_BIT] or left == 0)
    request = assign((avm_m0.write, avm_m0.read), lambda: (writing, state == BridgeState.READ))
    pass_on = assign((avm_m0.address, avm_m0.writedata, avm_m0.byteenable), lambda: (address, shown, every_lane))
    count_on = assign(next_address, lambda: address + 1 if address != last_address else 0)
    choose_answer = assign(answer, lambda: head if at_head else avm_m0.readdata)

    # headless: no access of the frame has begun. at_head: the first word of the answer is next.
    @always_seq(clk.posedge, reset=reset)
    def step():
        if good:
            waiting.next = True
        elif take:
            waiting.next = False
        if take:
            state.next = BridgeState.FETCH
            stop.next = words
            place.next = left.next = 0
            headless.next = True
        elif state == BridgeState.FETCH:
            state.next = BridgeState.STEP
        elif stepping and at_stop:
            state.next = BridgeState.REPLY
            if headless:
                state.next = BridgeState.IDLE
        elif writing:
            if not avm_m0.waitrequest:
                state.next = BridgeState.FETCH
                place.next = place + 1
                left.next = left - 1
                address.next = next_address
        elif stepping:
            state.next = BridgeState.REPLY
            if shown[WRITE_BIT]:
                state.next = BridgeState.FETCH
            headless.next = False
            place.next = place + 1
            head.next = shown
            address.next = shown[address_bits:]
            left.next = shown[count_high:count_low]
        elif state == BridgeState.REPLY:
            state.next = BridgeState.SEND
            at_head.next = True
        elif offering and offered:
            at_head.next = False
            state.next = BridgeState.READ
            if last:
                state.next = BridgeState.IDLE
        elif state == BridgeState.READ and not avm_m0.waitrequest:
            state.next = BridgeState.AWAIT
            left.next = left - 1
            address.next = next_address
        elif state == BridgeState.AWAIT and avm_m0.readdatavalid:
            state.next = BridgeState.SEND

    return instances()
