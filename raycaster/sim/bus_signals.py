# SPDX-License-Identifier: MIT
"""Generate the part of the bench for a bus with a bridge: its signals, and the design's connections to them."""

from __future__ import annotations

from raycaster.buses import BUSES
from raycaster.configuration import Configuration
from raycaster.registers import address_bits
from raycaster.rtl.bus.buses import BRIDGES


def bus_files(configuration: Configuration) -> dict[str, str]:
    """Generate the files that `bench.v` includes, by name.

    A driver of the bus drives in mid-cycle; the design sees the signals from the next edge of the clock on, under their
    names with the prefix `seen_`.
    """
    prefix, bridge = BUSES[configuration.bus].port, BRIDGES[configuration.bus]
    port = bridge.interface(address_bits(*configuration.map))
    signals, seen, ports = [], [], []
    for attribute, signal in vars(port).items():
        name, width = f"{prefix}_{attribute}", len(signal)
        shape = f"[{width - 1}:0] " if width else ""
        if attribute in port.outputs:
            signals.append(f"wire {shape}{name} /*verilator public_flat_rw*/;")
            ports.append(f".{name}({name}),")
            continue
        signals += [f"reg {shape}{one} /*verilator public_flat_rw*/;" for one in (name, f"seen_{name}")]
        seen.append(f"    seen_{name} <= {name};")
        ports.append(f".{name}(seen_{name}),")
    texts = {
        "bus_signals.vh": [*signals, "always @(posedge clk) begin", *seen, "end"],
        "bus_ports.vh": ports,
    }
    return {name: "".join(f"{line}\n" for line in lines) for name, lines in texts.items()}
