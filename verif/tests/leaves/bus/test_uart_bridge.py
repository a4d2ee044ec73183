# SPDX-License-Identifier: MIT
"""Leaf test of `uart_bridge` with an agent that has words: accesses in frames, spoilt frames, answers that are cut."""

from myhdl import always, always_comb, always_seq, block, instances
from serial_vectors import bytes_in, in_time, levels_of
from vectors import any_word, by

from raycaster.hdl.signals import Unset, bit
from raycaster.rtl.bus.uart_bridge import UartPort, uart_bridge
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import LANES, WORD_BITS
from raycaster.serial_frames import LEAD, FrameDecoder, access, framed

CLOCK_HZ, BAUD, PLACES = 25_000_000, 3_125_000, 12
CYCLES = CLOCK_HZ // BAUD
ADDRESS_BITS = 4
ADDRESSES = 1 << ADDRESS_BITS


@block
def bridge_with_agent(clk, reset, uart, waits, written, lanes, address, data, clock_hz: int, baud: int, places: int):
    """Connect a bridge to an agent with a word at each address, which answers a read two cycles later.

    Args:
        clk: the clock.
        reset: synchronous, active high.
        uart: `UartPort`, the bridge's.
        waits: flag; the agent accepts nothing in this cycle.
        written: output flag; a write is accepted.
        lanes: unsigned, 4 bits; output, the bytes that are written.
        address: unsigned; output, the transfer's address.
        data: unsigned, 32 bits; output, the word that is written.
        clock_hz: as for the bridge.
        baud: as for the bridge.
        places: as for the bridge.
    """
    bus = AvalonPort(len(address))
    memory, reading = Unset(1 << len(address), WORD_BITS), bit()

    bridge = uart_bridge(clk, reset, uart=uart, avm_m0=bus, clock_hz=clock_hz, baud=baud, places=places)  # noqa: F841

    @always_comb
    def show():
        bus.waitrequest.next = waits
        written.next = bus.write and not waits
        lanes.next = bus.byteenable
        address.next = bus.address
        data.next = bus.writedata

    @always(clk.posedge)
    def store():
        if bus.write and not waits:
            memory[bus.address].next = bus.writedata

    @always(clk.posedge)
    def fetch():
        if bus.read and not waits:
            bus.readdata.next = memory[bus.address]

    @always_seq(clk.posedge, reset=reset)
    def answer():
        reading.next = bus.read and not waits
        bus.readdatavalid.next = reading

    return instances()


@by(patience=[0.0, 0.3, 0.8])
def test_uart_bridge(patience, leaf_of, random):
    leaf = leaf_of(
        bridge_with_agent, uart=lambda: UartPort(0), lanes=LANES, address=ADDRESS_BITS, data=WORD_BITS,
        clock_hz=CLOCK_HZ, baud=BAUD, places=PLACES,
    )  # fmt: skip
    leaf.case({"reset": 1, "uart_rx": 1, "waits": 0})
    memory, written, answers = {}, [], []

    def drive(line):
        for level in line:
            leaf.case({"reset": 0, "uart_rx": level, "waits": random.random() < patience})

    def send(words, *, hears=True, waits=True):
        """Send a frame, which is carried out, and whose answer is heard as a whole; wait for that."""
        drive(in_time(levels_of([LEAD, *framed(words)]), CYCLES))
        at, answer = 0, []
        while at < len(words):
            head, at = words[at], at + 1
            address, count = head % ADDRESSES, head >> 16 & 0x3FF
            if head >> 31:
                for number, word in enumerate(words[at : at + count]):
                    memory[(address + number) % ADDRESSES] = word
                    written.append(((address + number) % ADDRESSES, word))
                at, answer = at + count, [head]
            else:
                answer = [head, *(memory[(address + number) % ADDRESSES] for number in range(count))]
                break
        if answer and hears:
            answers.append(answer)
        if hears and waits:
            drive([1] * (CYCLES * 10 * (10 + 9 * len(answer))))

    def spoil(words):
        """Send a frame with a wrong bit."""
        data = bytearray(framed(words))
        place = int(random.integers(1, len(data) - 1))
        data[place] ^= 1 << int(random.integers(8))
        if not {0x7D, 0x7E} & {data[place], data[place] ^ 1}:
            drive(in_time(levels_of([LEAD, *data]), CYCLES))

    def some(count):
        return [any_word(random) for _ in range(count)]

    send([])
    for address in range(0, ADDRESSES, 4):
        send(access(address, some(4)))
    settled = leaf.cycle
    for number in range(leaf.some(30)):
        address, other = (int(place) for place in random.integers(ADDRESSES, size=2))
        match number % 6:
            case 0:  # a write, and a read of what was written
                send([*access(address, some(3)), *access(address, read=3)])
            case 1:  # nothing follows a read
                send([*access(address, read=2), *access(other, some(2))])
            case 2:  # two writes; a count of 0; bits that are above the address
                send([*access(address, some(2)), 1 << 31 | other, *access(other | 0xFFF0, some(4))])
            case 3:  # a wrong bit
                spoil(access(address, some(4)))
            case 4:  # the next frame cuts this answer short, and is carried out before a third one overwrites its words
                send(access(address, read=20), hears=False)
                drive([1] * (CYCLES * int(random.integers(10, 40))))
                send(access(other, some(1)), waits=False)
                spoil(access(other, some(1)))
                drive([1] * (CYCLES * 100))
            case 5:  # a frame follows a long write at once, and a write that ends before its last word
                send(access(address, some(8)), waits=False)
                send([*access(other, some(4))[:-1]])
    outputs = leaf.check(settled=settled)
    seen = [(one["address"], one["data"]) for one in outputs if one["written"]]
    assert seen == written
    assert all(one["lanes"] == 0b1111 for one in outputs)
    decoder, heard = FrameDecoder(), bytes_in([one["uart_tx"] for one in outputs], CYCLES)
    assert list(decoder.feed(bytes(byte for byte, _ in heard))) == answers
