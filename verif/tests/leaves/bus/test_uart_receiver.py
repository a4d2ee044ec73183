# SPDX-License-Identifier: MIT
"""Leaf test of `uart_receiver`: hosts that are up to 3 per cent fast or slow, glitches, breaks and lost stop bits."""

from serial_vectors import in_time, levels_of, rates
from vectors import by

from raycaster.rtl.bus.uart_receiver import uart_receiver


@rates
@by(error=[-0.03, 0.03, 0.0])
def test_uart_receiver(clock_hz, baud, error, leaf_of, random):
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
