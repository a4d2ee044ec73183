# SPDX-License-Identifier: MIT
"""The tops as Verilog, one file a module, with what other flows want beside them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path

from myhdl._block import _Block

from raycaster.configuration import Configuration
from raycaster.convert.elaboration import elaboration
from raycaster.convert.hierarchy import Module, convert_hierarchy
from raycaster.convert.inside import state_names
from raycaster.convert.take_home import write_take_home
from raycaster.memory_map import PROGRAM_FILE
from raycaster.output import replaced
from raycaster.rtl.dvi.dvi_encoder import DviPorts, dvi_encoder
from raycaster.rtl.system.processor_system import ProcessorPorts, processor_system
from raycaster.rtl.system.ray_caster_module import ModulePorts, ray_caster_module
from raycaster.rtl.system.ray_caster_system import SystemPorts, ray_caster_system
from raycaster.scene import Scene


def write_verilog(config: Configuration, directory: Path) -> list[Path]:
    """Generate the Verilog of a configuration; the same configuration gives the same bytes.

    Args:
        config: what to generate.
        directory: replaced as a whole, once everything is generated.

    Returns:
        The modules' files, each after those that it instantiates; the top, `ray_caster_module.v`, is the last.
    """

    def elaborate() -> _Block:
        return ray_caster_module(**ModulePorts(config).all(), config=config)

    return _write(elaborate, config, directory, partial(write_take_home, config))


def design_states(config: Configuration) -> dict[tuple[str, str], dict[int, str]]:
    """The enumerated signals of a configuration's design; see `raycaster.convert.inside.state_names`."""
    with elaboration():
        return state_names(ray_caster_module(**ModulePorts(config).all(), config=config))


def write_system(config: Configuration, scene: Scene, directory: Path) -> list[Path]:
    """Generate the Verilog of a system without a processor, otherwise as `write_verilog`.

    Args:
        config: what to generate.
        scene: what it shows; it has no more rectangles than the hardware.
        directory: replaced as a whole, once everything is generated.

    Returns:
        The modules' files, each after those that it instantiates; the top, `ray_caster_system.v`, is the last.
    """

    def elaborate() -> _Block:
        return ray_caster_system(**SystemPorts(config).all(), config=config, scene=scene)

    return _write(elaborate, config, directory)


def write_processor_system(config: Configuration, directory: Path, program: str = PROGRAM_FILE) -> list[Path]:
    """Generate the Verilog of a system with a processor, otherwise as `write_verilog`.

    Args:
        config: what to generate.
        directory: replaced as a whole, once everything is generated.
        program: the file with the words of the program, in hexadecimal, which simulators open where they run, and
            synthesis where it reads the Verilog.

    Returns:
        The modules' files, each after those that it instantiates; the top, `processor_system.v`, is the last. PicoRV32
        is among them as it was given.

    Raises:
        UserError: PicoRV32 is not installed.
    """

    def elaborate() -> _Block:
        return processor_system(**ProcessorPorts(config).all(), config=config, program=program)

    return _write(elaborate, config, directory)


def write_dvi_encoder(config: Configuration, directory: Path) -> list[Path]:
    """Generate the Verilog of what stands between the VGA output, of 8 bits a colour, and a DVI link.

    Args:
        config: of the design that it goes with, for the files' heads.
        directory: replaced as a whole, once everything is generated.

    Returns:
        The modules' files, each after those that it instantiates; the top, `dvi_encoder.v`, is the last.
    """

    def elaborate() -> _Block:
        return dvi_encoder(**DviPorts().all())

    return _write(elaborate, config, directory)


def _write(
    elaborate: Callable[[], _Block],
    config: Configuration,
    directory: Path,
    complete: Callable[[list[Module], Path], None] | None = None,
) -> list[Path]:
    with replaced(directory) as written:
        with elaboration():
            modules = convert_hierarchy(elaborate(), written, _header(config))
        if complete:
            complete(modules, written)
    return [directory / module.path.name for module in modules]


def _header(config: Configuration) -> str:
    return f"// RayCaster: {{module}}\n// Configuration: {config.name}\n// SPDX-License-Identifier: MIT"
