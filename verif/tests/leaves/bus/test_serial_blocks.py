# SPDX-License-Identifier: MIT
"""Leaf tests of the serial line's blocks: bits in time, bytes, frames, and accesses in frames."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Sequence

import pytest
from myhdl import always, always_comb, always_seq, block, instances
from vectors import any_word, by

from raycaster.hdl.signals import Unset, bit
from raycaster.memory_map import clocks_per_bit
from raycaster.rtl.bus.bit_timer import bit_timer
from raycaster.rtl.bus.frame_check import CHECK_CYCLES, RESIDUE, frame_check
from raycaster.rtl.bus.frame_reader import frame_reader
from raycaster.rtl.bus.frame_writer import frame_writer
from raycaster.rtl.bus.uart_bridge import UartPort, uart_bridge
from raycaster.rtl.bus.uart_receiver import uart_receiver
from raycaster.rtl.bus.uart_transmitter import uart_transmitter
from raycaster.rtl.common.interfaces import AvalonPort
from raycaster.rtl.common.widths import LANES, WORD_BITS
from raycaster.serial_frames import ESCAPE, ESCAPED, FLAG, LEAD, FrameDecoder, access, framed

rates = by(clock_hz=[25_000_000], baud=[3_500_000, 3_000_000, 3_125_000])
"""A clock of 7.14, 8.33 and 8 cycles per bit; the fewest that a design may have are 7.02."""

BYTE_BITS = 10


def levels_of(data: Iterable[int]) -> list[int]:
    """Return the levels of bytes, one per bit: start bit, the bits from the lowest on, stop bit."""
    return [level for byte in data for level in (0, *(byte >> at & 1 for at in range(8)), 1)]


def in_time(levels: Sequence[int], cycles: float, offset: float = 0.0) -> list[int]:
    """Return the level in each cycle, given a bit's length in cycles, and the idle line's before it."""
    count = round(len(levels) * cycles)
    return [levels[max(0, min(len(levels) - 1, int((cycle - offset) / cycles)))] if cycle >= offset else 1
            for cycle in range(count)]  # fmt: skip


def bytes_in(line: Sequence[int], cycles: float) -> list[tuple[int, int]]:
    """Return the bytes on a line, each with the cycle in which its start bit begins; there must be a stop bit."""
    found, cycle = [], 1
    while cycle < len(line):
        if line[cycle - 1] and not line[cycle]:
            bits = [line[min(len(line) - 1, int(cycle + (place + 0.5) * cycles))] for place in range(BYTE_BITS)]
            assert bits[0] == 0 and bits[-1] == 1, f"cycle {cycle}: {bits}"
            found.append((sum(bit << place for place, bit in enumerate(bits[1:-1])), cycle))
            cycle += int((BYTE_BITS - 0.5) * cycles)
        cycle += 1
    return found


@pytest.mark.parametrize("middle", [True, False])
@pytest.mark.parametrize("baud", [9_600, 115_200, 1_000_000, 3_000_000, 3_562_500])
def test_bit_timer(baud, middle, leaf_of, random):
    """Each mark is within a cycle of its time, at a rate that is right within 0.2 per cent."""
    clock_hz, bits = 25_000_000, 10
    cycles = clock_hz / baud
    leaf = leaf_of(bit_timer, clock_hz=clock_hz, baud=baud, middle=middle)
    begins = []
    for _ in range(2 if cycles > 1000 else 4):
        begins.append(leaf.cycle)
        leaf.case({"restart": 1})
        for _ in range(int((bits + random.random()) * cycles)):
            leaf.case({"restart": 0})
    outputs = leaf.check(settled=1)
    for begin, end in zip(begins, [*begins[1:], leaf.cycle], strict=True):
        marks = [cycle for cycle in range(begin + 1, end) if outputs[cycle]["tick"]]
        assert len(marks) >= bits
        for number, mark in enumerate(marks[:bits]):
            # A sender's bit ends after cycle `mark`; a receiver's byte began up to a cycle before it was seen.
            ideal = (number + 0.5) * cycles - 0.5 if middle else (number + 1) * cycles
            off, rounded = mark - begin - ideal, 0.002 * ideal + 0.1
            least, most = (-0.5, 0.5) if middle else (0, 1)
            assert least - rounded < off < most + rounded, (number, off)


@rates
@by(error=[-0.03, 0.03, 0.0])
def test_uart_receiver(clock_hz, baud, error, leaf_of, random):
    """Hosts that are up to 3 per cent fast or slow, glitches, breaks and lost stop bits."""
    leaf = leaf_of(uart_receiver, data=8, clock_hz=clock_hz, baud=baud)
    leaf.case({"reset": 1, "uart_rx": 1})
    cycles, sent = clock_hz / baud / (1 + error), []

    def drive(line):
        for level in line:
            leaf.case({"reset": 0, "uart_rx": level})

    def idle():
        drive([1] * int((1 + random.random()) * cycles))

    for number in range(leaf.some(90)):
        data = [int(byte) for byte in random.integers(256, size=1 + number % 3)]
        match number % 6:
            case 3:  # a glitch that is over before the middle of a start bit
                drive([0] * int(random.integers(1, int(cycles / 2) - 1)))
                drive([1] * 10)
            case 4:  # a byte without its stop bit, and a line that is low for long
                drive(in_time([*levels_of(data[:1])[:-1], *[0] * int(random.integers(1, 30))], cycles))
                idle()
            case _:
                drive(in_time(levels_of(data), cycles, random.random()))
                sent += data
                if number % 6 == 5:  # the next byte follows at once
                    continue
        idle()
    drive([1] * 20)
    outputs = leaf.check(settled=1)
    assert [one["data"] for one in outputs if one["received"]] == sent


def test_a_reset_in_a_byte(leaf_of):
    """The rest of a byte may look like another one, which the byte 0xFF ends, and with itself nothing else."""
    leaf = leaf_of(uart_receiver, data=8, clock_hz=8, baud=1)
    for cycle, level in enumerate(in_time(levels_of([0x0F, 0xFF, 0x5A]), 8)):
        leaf.case({"reset": cycle in (0, 30), "uart_rx": level})
    for _ in range(20):
        leaf.case({"reset": 0, "uart_rx": 1})
    outputs = leaf.check(settled=1)
    assert [one["data"] for one in outputs if one["received"]][-1] == 0x5A


def test_clocks_per_bit():
    """Rounded rates are close enough: a receiver tolerates a few per cent."""
    assert [clocks_per_bit(hz) for hz in (50_000_000, 25_000_000, 6_000_000)] == [434, 217, 52]


@rates
def test_uart_transmitter(clock_hz, baud, leaf_of, random):
    """A byte is accepted when the line is free, and each of its bits has its time, rounded up to a cycle."""
    leaf, cycles = leaf_of(uart_transmitter, data=8, clock_hz=clock_hz, baud=baud), clock_hz / baud
    exact = cycles == round(cycles)
    leaf.case({"reset": 1})
    waits, begun, levels = None, 0, []  # the byte that waits, the cycle in which a byte began, and its levels
    for _ in range(leaf.some(6000)):
        if waits is None and random.random() < 0.02:
            waits = int(random.integers(256))
        reset = int(random.random() < 0.1 / (BYTE_BITS * cycles))
        age = leaf.cycle - begun
        # With a rounded rate, an edge may come a cycle early or late; then nothing waits.
        spread = 0 if exact else 1
        earliest, latest = (int((age + off) / cycles) for off in (-spread, spread))
        certain, free = earliest == latest, not levels or earliest >= BYTE_BITS
        valid = waits is not None and (certain or latest < BYTE_BITS or free)
        leaf.case({"reset": reset, "valid": valid, "data": waits if valid else random.integers(256)})
        leaf.expect({"ready": free}, when=free or latest < BYTE_BITS)
        leaf.expect({"uart_tx": 1 if free else levels[earliest]}, when=free or (certain and latest < BYTE_BITS))
        if reset:
            waits, levels = None, []
        elif free and valid:
            begun, levels, waits = leaf.cycle, levels_of([waits]), None
    leaf.check(settled=1)


def test_frame_check(leaf_of, random):
    """The CRC-32 of Python's zlib."""
    leaf = leaf_of(frame_check, data=8, state=32)
    for number in range(30):
        data = bytes(int(byte) for byte in random.integers(256, size=number % 7))
        if number % 2:
            data += zlib.crc32(data).to_bytes(4, "little")
        leaf.case({"clear": 1, "add": random.integers(2), "data": random.integers(256)})
        for length in range(len(data) + 1):
            said = {"state": zlib.crc32(data[:length]) ^ 0xFFFFFFFF}
            for _ in range(random.integers(3)):
                leaf.case({"clear": 0, "add": 0, "data": random.integers(256)}, said)
            if length < len(data):
                leaf.case({"clear": 0, "add": 1, "data": data[length]}, said)
                for _ in range(CHECK_CYCLES - 1):
                    leaf.case({"clear": 0, "add": 0, "data": random.integers(256)})
        if number % 2:
            leaf.case({"clear": 0, "add": 0, "data": 0}, {"state": RESIDUE})
    leaf.check(settled=1)


ODD_WORDS = (0x7E7E_7E7E, 0x7D7D_7D7D, 0x5E5D_7D7E, 0, 0xFFFF_FFFF)


def spoilt(data: bytes, kind: int, random) -> bytes:
    """Return what is left of a frame; it ends with a flag, and is none."""
    at = int(random.integers(1, len(data) - 2))
    match kind:
        case 0:  # a wrong bit
            wrong = data[at] ^ 1 << int(random.integers(8))
            return bytes([*data[:at], wrong, *data[at + 1 :]])
        case 1:  # a lost byte
            return data[:at] + data[at + 1 :]
        case 2:  # the cable pulled
            return data[:at] + bytes([FLAG])
        case 3:  # an abort
            return data[:-1] + bytes([ESCAPE, FLAG])
        case _:  # a byte more
            return data[:at] + bytes([0x55]) + data[at:]


def wrong_checks() -> list[int]:
    """Return what a check must differ by so that the reader's state is wrong in one bit alone, for each bit."""
    rows = [(zlib.crc32((1 << place).to_bytes(4, "little")) ^ zlib.crc32(bytes(4)), 1 << place) for place in range(32)]
    for place in range(32):
        pivot = next(row for row in rows[place:] if row[0] >> place & 1)
        rows.remove(pivot)
        rows = [(a ^ pivot[0], b ^ pivot[1]) if a >> place & 1 else (a, b) for a, b in rows]
        rows.insert(place, pivot)
    return [difference for _, difference in rows]


def stuffed(plain: bytes, check: int) -> bytes:
    """Return bytes between two flags, with any check."""
    plain += check.to_bytes(4, "little")
    return b"".join(bytes([ESCAPE, one ^ ESCAPED] if one in (FLAG, ESCAPE) else [one]) for one in plain)


@pytest.mark.parametrize("places", [5, 8, 59])
def test_frame_reader(places, leaf_of, random):
    """Frames of any length, and what is no frame between them."""
    width = (places - 1).bit_length()
    leaf = leaf_of(frame_reader, data=8, words=width, place=width, shown=32, places=places)
    leaf.case({"reset": 1})
    goods = 0

    def cycle(received=0, data=None, reset=0):
        place = int(random.integers(places))
        data = random.integers(256) if data is None else data
        leaf.case({"reset": reset, "received": received, "data": data, "place": place})
        return place

    def receive(data):
        for byte in data:
            cycle(1, byte)
            for _ in range(CHECK_CYCLES - 1 + int(random.integers(2))):
                cycle()
                leaf.expect({"good": 0}, when=byte != FLAG)

    def flag(words):
        """Expect a frame or none, and read all its words; they stay as long as nothing else comes."""
        nonlocal goods
        cycle(1, FLAG)
        cycle()
        leaf.expect({"good": words is not None})
        if words is not None:
            goods += 1
            leaf.expect({"words": len(words)})
            for place, word in enumerate(words):
                leaf.case({"reset": 0, "received": 0, "data": 0, "place": place})
                leaf.case({"reset": 0, "received": 0, "data": 0, "place": 0}, {"shown": word, "words": len(words)})
        for _ in range(CHECK_CYCLES):
            cycle()
            leaf.expect({"good": 0})

    # A memory is unknown until each place has been written.
    flag(None)
    receive(framed([0] * (places - 1))[:-1])
    settled = leaf.cycle
    flag([0] * (places - 1))
    for difference in wrong_checks():
        plain = random.bytes(4)
        receive(stuffed(plain, zlib.crc32(plain) ^ difference))
        flag(None)
    for length in range(1, 8):  # no whole words, with the right check
        plain = random.bytes(length)
        receive(stuffed(plain, zlib.crc32(plain)))
        flag(None if length % 4 else [int.from_bytes(plain, "little")])
    for number in range(leaf.some(90)):
        length = int(random.integers(places)) if number % 9 else places - 1
        words = [any_word(random) if random.random() < 0.7 else int(random.choice(ODD_WORDS)) for _ in range(length)]
        if number % 7 == 3:  # too long
            receive(framed([*words, *[1] * (places - length)])[:-1])
            flag(None)
        elif number % 7 == 5:
            data = spoilt(framed([*words, 0x1234]), number // 7 % 5, random)
            if FLAG not in data[1:-1]:
                receive(data[:-1])
                flag(None)
        elif number % 7 == 6 and length:  # a reset in a frame
            # The rest is the check, as of a frame without words.
            receive(framed(words)[:-5])
            cycle(reset=1)
            receive(framed(words)[-5:-1])
            flag(None)
        else:
            receive(framed(words)[:-1])
            flag(words)
    leaf.check(settled=settled)
    assert goods > 10


def test_frame_writer(leaf_of, random):
    """The bytes of frames, some of which another one cuts."""
    leaf = leaf_of(frame_writer, word=32, data=8)
    leaf.case({"reset": 1})
    for number in range(leaf.some(60)):
        odd = [0x7E7E_7E7E, 0x7D7D_7D7D, 0x007D_7E00]
        words = [any_word(random) if random.random() < 0.6 else odd[int(random.integers(3))]
                 for _ in range(1 + number % 4)]  # fmt: skip
        expected = framed(words)
        cut = int(random.integers(len(expected))) if number % 5 == 4 else len(expected)
        leaf.case({"reset": 0, "start": 1, "valid": 0, "accepted": 0, "word": 0, "last": 0})
        taken, sent, busy = 0, 0, CHECK_CYCLES
        wait = int(random.integers(3))
        while sent < cut:
            # The word that byte number `sent` belongs to.
            inside = sent > 0 and taken < len(words)
            valid = inside and wait == 0
            wait = max(0, wait - 1)
            accepted = busy == 0
            busy = max(0, busy - 1)
            word = words[taken] if valid else any_word(random)
            leaf.case({"start": 0, "valid": valid, "word": word, "last": taken == len(words) - 1 if valid else
                       random.integers(2), "accepted": accepted})  # fmt: skip
            sends = valid or not inside
            leaf.expect({"sending": sends})
            leaf.expect({"data": expected[sent]}, when=sends and accepted)
            if not (sends and accepted):
                leaf.expect({"ready": 0})
                continue
            sent, busy = sent + 1, CHECK_CYCLES + int(random.integers(3))
            # A word is accepted with its last byte.
            whole = inside and sent == 1 + plain_end(words, taken)
            leaf.expect({"ready": whole})
            if whole:
                taken, wait = taken + 1, int(random.integers(12))
        if cut == len(expected):
            leaf.case({"start": 0, "valid": 1, "word": 0, "last": 0, "accepted": 1}, {"sending": 0, "ready": 0})
    leaf.check(settled=1)


def plain_end(words, number: int) -> int:
    """Return the bytes, escaped, of the words up to this one."""
    return sum(2 if byte in (0x7D, 0x7E) else 1 for word in words[: number + 1] for byte in word.to_bytes(4, "little"))


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
    """Accesses in frames, spoilt frames, answers that are cut."""
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
