# SPDX-License-Identifier: MIT
"""The bench of a leaf test, which runs the same vectors through MyHDL and the converted Verilog, and its vectors."""

from __future__ import annotations

import inspect
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from raycaster.configuration import WORLD_SIZE, Configuration
from raycaster.design.decide import configure
from raycaster.hdl.internals import SignalType
from raycaster.hdl.leaf import Leaf
from raycaster.hdl.records import Interface, Record
from raycaster.hdl.signals import Signed, bit, reset_signal, signed, tied, unsigned
from raycaster.registers import address_bits
from raycaster.rtl.common import interfaces, records, widths
from raycaster.rtl.cull.rect_setup import Facet
from raycaster.rtl.engines import engine_of
from raycaster.rtl.exact.eye_register import Mirror
from raycaster.rtl.span import records as span
from raycaster.verif.random_world import EXTREMES
from raycaster.verif.seeds import repeat

PORTS: dict[str, int | Callable[[Any], Any]] = {
    "reset": lambda _: reset_signal(),
    "access": lambda _: interfaces.Access(),
    "bus": lambda config: interfaces.SceneBus(address_bits(*config.map)),
    "camera": records.Camera,
    "column_base": lambda config: unsigned(widths.unit_bits(config)),
    "data": widths.WORD_BITS,
    "denominator": lambda config: unsigned(widths.exact_slope_bits(config)),
    "eye": lambda config: interfaces.Vector(widths.eye_bits(config)),
    "facet": Facet,
    "fate": lambda _: interfaces.RayFate(),
    "found_colour": widths.RGB_BITS,
    "found_distance": lambda config: unsigned(widths.eye_distance_bits(config)),
    "found_mirror": lambda config: unsigned(widths.MIRROR_BITS) if config.materials else tied(0, widths.MIRROR_BITS),
    "found_slope": lambda config: unsigned(widths.exact_slope_bits(config)),
    "found_surface": records.Surface,
    "index": lambda config: unsigned(widths.index_bits(config)),
    "initial_signs": lambda _: records.Signs(),
    "may_hit": lambda config: unsigned(config.rectangles),
    "mirror": Mirror,
    "numerator": lambda config: unsigned(widths.eye_distance_bits(config)),
    "offered": lambda config: (records.Rect if config.facts.divides else records.Surface)(config),
    "picture": lambda _: interfaces.Picture(),
    "pixel": lambda config: records.Pixel(config.colour_bits),
    "place": interfaces.Place,
    "progress": interfaces.Progress,
    "readback": widths.WORD_BITS,
    "rect": records.Rect,
    "rects": interfaces.Rects,
    "share": lambda config: unsigned(widths.share_bits(config)),
    "signs": lambda _: records.Signs(),
    "slope": lambda config: interfaces.Slope(widths.exact_slope_bits(config)),
    "steps": lambda _: interfaces.Steps(),
    "strobe": widths.LANES,
    "vga": lambda config: interfaces.Vga(config.port_bits),
}
"""Widths and signals of the ports whose names mean the same in most blocks."""

SPAN_PORTS: dict[str, int | Callable[[Any], Any]] = PORTS | {
    "aim": span.Aim,
    "answer": span.Answer,
    "asks": span.Asks,
    "division": span.Division,
    "number": lambda config: unsigned(widths.index_bits(config)),
    "query": span.Query,
    "run": span.Run,
    "seen_colour": widths.RGB_BITS,
    "slope": lambda config: interfaces.Vector(widths.signed_slope_bits(config)),
    "step": lambda config: interfaces.Vector(widths.step_bits(config)),
    "stored": records.Rect,
    "usable": lambda config: unsigned(config.rectangles),
    **dict.fromkeys(("chain", "fan", "folded"), span.Chain),
    **dict.fromkeys(("entry", "given", "heir", "met", "tested", "winner"), span.Entry),
    **dict.fromkeys(("frame", "kept"), span.Frame),
    **dict.fromkeys(("count", "entry_count"), lambda config: unsigned(widths.count_bits(config))),
    **dict.fromkeys(("level", "looked", "seen"), lambda config: unsigned(widths.level_bits(config))),
    **dict.fromkeys(("seen_share", "weight"), lambda config: unsigned(widths.weight_bits(config))),
    **dict.fromkeys(
        ("column", "columns", "left", "next_column", "next_dark", "part_stop", "place", "right", "stop", "swept_stop"),
        lambda config: unsigned(widths.column_bits(config)),
    ),
}
"""Ports of the span engine's blocks."""


def is_port(parameter: inspect.Parameter) -> bool:
    """Return True if a block's argument is a port: it has no default, and no type or that of a signal or interface."""
    kind = SignalType if parameter.annotation is parameter.empty else parameter.annotation
    port = isinstance(kind, type) and issubclass(kind, (SignalType, Interface))
    return port and parameter.default is parameter.empty


class Bench(Leaf):
    """A block with new signals at its ports, its stimulus, and the outputs that are expected.

    Args:
        block: the block.
        directory: scratch space for the Verilog.
        config: the design, which sizes the ports of `PORTS`, or of `SPAN_PORTS` in a design of the span engine.
        given: by name, a port's width (`Signed` for two's complement) or a function that makes its signal; an argument
            that `is_port` excludes is passed on. A port that is neither here nor there is a bit.
    """

    few: ClassVar[bool] = False
    """True if slow tests are left out, and with them most of the random cases of long leaf tests."""

    def __init__(self, block: Callable, directory: Path, config: Any = None, **given: Any):
        parameters = inspect.signature(block).parameters
        assert set(given) <= set(parameters), set(given) - set(parameters)

        def argument(name: str) -> object:
            parameter = parameters[name]
            if name == "config":
                return config
            if name in ("control", "unit") and config is not None:
                return engine_of(config).blocks[name == "unit"]
            if not is_port(parameter):
                return given[name]
            known = SPAN_PORTS if config is not None and config.facts.whole_frames else PORTS
            made = given.get(name, known.get(name, lambda _: bit()))
            if isinstance(made, int):
                return signed(made) if isinstance(made, Signed) else unsigned(made)
            return made() if name in given else made(config)

        names = [name for name, one in parameters.items() if one.default is one.empty or name in given]
        super().__init__(block, lambda: {name: argument(name) for name in names}, directory)
        self.stimulus: list[Mapping[str, Any]] = []
        """By cycle, the inputs, as for `run_both`; negative numbers are two's complement."""
        self.expected: dict[int, Mapping[str, Any]] = defaultdict(dict)
        """By cycle of the stimulus, all or some outputs; None for don't care."""

    def some(self, count: int) -> int:
        """Return how many random cases to test: the count, or a third of it if slow tests are left out."""
        return count // 3 if self.few else count

    @property
    def cycle(self) -> int:
        """The number of the next cycle."""
        return len(self.stimulus)

    def case(self, inputs: Mapping[str, Any], outputs: Mapping[str, Any] | None = None) -> None:
        """Add a cycle with these inputs, from which these outputs follow; None for don't care."""
        self.stimulus.append(inputs)
        self.expect(outputs)

    def expect(self, outputs: Mapping[str, Any] | None, when: object = True) -> None:
        """Expect these outputs from the last cycle added, if the condition holds."""
        if outputs and when:
            self.expected[self.cycle - 1] |= outputs

    def check(self, latency: int = 0, settled: int | None = None, spare: bool = False) -> Sequence[Mapping[str, Any]]:
        """Run the stimulus in both simulators, compare the outputs with those expected, and return them.

        Args:
            latency: cycles from the inputs of a case to its outputs.
            settled: the first cycle in which all outputs are known and compared, by default after the latency.
            spare: ignore inputs that this leaf lacks, such as those of features that its design lacks.
        """
        settled = latency if settled is None else settled
        inputs = [
            {name: int(value) for name, value in cycle.items() if name in self.given or not spare}
            for cycle in [*self.stimulus, *[{}] * latency]
        ]
        outputs = self.run_both(inputs, settled)
        for cycle, wanted in self.expected.items():
            for name, value in wanted.items():
                if value is not None and cycle + latency >= settled:
                    seen, span = outputs[cycle + latency][name], 1 << self.seen[name].width
                    right = value == int(value) and -span <= 2 * value < 2 * span and seen == int(value) % span
                    assert right, f"cycle {cycle + latency}: {name} is {seen}, expected {value}; {repeat()}"
        return outputs


def check_fetches(outputs: Sequence[Mapping[str, Any]], shown: Mapping[int, int], port: str, settled: int = 0) -> None:
    """Check that the block has fetched each rectangle before the cycle in which the memory shows it.

    Args:
        outputs: the block's outputs, by cycle.
        shown: indices of rectangles, by cycle.
        port: prefix of the block's outputs fetch and index.
        settled: the first cycle in which fetches are known and compared.
    """
    fetched = None
    for cycle, output in enumerate(outputs):
        if cycle >= settled and cycle in shown:
            assert fetched == shown[cycle], f"cycle {cycle}: fetched rectangle {fetched}, not {shown[cycle]}"
        if output[f"{port}fetch"]:
            fetched = output[f"{port}index"]


AXES = "xyz"

LAST = WORLD_SIZE - 1

EVERY_LANE = (1 << widths.LANES) - 1

STEP = 3
"""World units per frame by which a button moves the camera."""


def stepped(position: int, more: int, less: int) -> int:
    """Return the position after a step; a step out of the world is not made."""
    target = position + STEP * (more - less)
    return target if 0 <= target < WORLD_SIZE else position


def any_config(**options: Any) -> Configuration:
    """Make a design; a row may take longer than its budget."""
    return configure(**{"allow_underrun": True} | options)


def unit_config(**options: Any) -> Configuration:
    """Make a design with few rectangles."""
    return any_config(**{"rectangles": 4} | options)


def exact_config(**options: Any) -> Configuration:
    """Make a design of the exact engine."""
    return any_config(engine="exact", **options)


def config_id(value) -> str | None:
    """Return the name of a parameter set that is a design or a block."""
    return value.name if isinstance(value, Configuration) else getattr(value, "__name__", None)


def designs(*configs: Configuration, slow: Sequence[str] = (), quick: Sequence[str] = ()) -> Callable:
    """Run a test for each of these designs, named after the design; slow and quick are as for `slow_sets`."""

    def marked(test: Callable) -> Callable:
        test = pytest.mark.slow_sets(*slow, quick=quick)(test) if slow or quick else test
        return pytest.mark.parametrize("config", configs, ids=config_id)(test)

    return marked


def by(**values: Iterable) -> Callable:
    """Run a test for all combinations of its arguments' values, which are in its name in this order."""

    def marked(test: Callable) -> Callable:
        for name, each in values.items():
            test = pytest.mark.parametrize(name, each)(test)
        return test

    return marked


by_turn, by_reflections = by(turn=[False, True]), by(reflections=[0, 1, 2])


def any_fields(random: np.random.Generator, record: Record) -> dict[str, int]:
    """Return random fields of a record, as unsigned numbers."""
    return {name: int.from_bytes(random.bytes(30)) % (1 << int(width)) for name, width in record.layout.items()}


def named(prefix: str, fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a record or an interface, named as at a port with this name."""
    return {f"{prefix}_{name}": value for name, value in fields.items()}


def by_axis(prefix: str, values: Iterable) -> dict[str, Any]:
    """Return a point or a vector as the components of a port; the prefix ends with `_` or `_d`."""
    return {f"{prefix}{axis}": value for axis, value in zip(AXES, values, strict=True)}


def slope_inputs(slope: Iterable, signs: str = "signs") -> dict[str, int]:
    """Return a slope in sign and magnitude."""
    slope = [int(value) for value in slope]
    return by_axis("slope_d", map(abs, slope)) | by_axis(f"{signs}_d", (int(value < 0) for value in slope))


def basis_inputs(basis: Iterable) -> dict[str, Any]:
    """Return the basis of a camera that turns."""
    inputs = {}
    for vector, components in zip(("forward", "right", "up"), basis, strict=True):
        inputs |= by_axis(f"camera_{vector}_", components)
    return inputs


def colour_word(colour: Iterable) -> int:
    """Return a colour as one word, red in its highest bits."""
    return int.from_bytes(bytes(np.asarray(colour, dtype=np.uint8)))


def any_place(random: np.random.Generator) -> int:
    """Return a coordinate in the world, often an extreme one."""
    return int(random.choice(EXTREMES)) if random.random() < 0.3 else int(random.integers(WORLD_SIZE))


def any_word(random: np.random.Generator) -> int:
    """Return a word of the bus."""
    return int(random.integers(1 << widths.WORD_BITS))


def any_strobe(random: np.random.Generator) -> int:
    """Return a strobe; half of them are reads."""
    return int(random.integers(1, EVERY_LANE + 1)) if random.random() < 0.5 else 0
