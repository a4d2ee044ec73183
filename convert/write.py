# SPDX-License-Identifier: MIT
"""The tops as Verilog, one file a module, with what other flows want beside them."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from myhdl._block import _Block

from raycaster.configuration import Configuration, need_avalon
from raycaster.convert.elaboration import elaborated, elaboration
from raycaster.convert.hierarchy import Module, convert_hierarchy
from raycaster.convert.inside import state_names
from raycaster.convert.take_home import PREFIX, write_take_home
from raycaster.errors import UserError
from raycaster.memory_map import PROGRAM_FILE
from raycaster.output import replaced
from raycaster.rtl.dvi.dvi_encoder import dvi_encoder
from raycaster.rtl.system.ports import dvi_ports, module_ports, scene_system_ports, system_ports
from raycaster.rtl.system.ray_caster_module import ray_caster_module
from raycaster.rtl.system.ray_caster_system import ray_caster_system
from raycaster.rtl.system.scene_system import scene_system
from raycaster.scene import Scene


def write_verilog(config: Configuration, directory: Path, prefix: str = "") -> list[Path]:
    """Write the ray tracer, `ray_caster_module`, and beside it what other flows want.

    This and the other functions here replace the directory as a whole, once everything is generated; equal arguments
    give equal bytes.

    Args:
        config: what to generate.
        directory: where to.
        prefix: of the names of all modules that do not begin with it, such as `PREFIX`, so that they are no others' in
            a larger design; none in the project's own simulations.

    Returns:
        The modules' files, each after those that it instantiates; the top is the last.

    Raises:
        UserError: the prefix is no beginning of a name in Verilog.
    """
    if prefix and not re.fullmatch(r"[A-Za-z_]\w*", prefix, re.ASCII):
        raise UserError(f"prefix: expected the beginning of a Verilog name, such as {PREFIX}, got {prefix}")
    return _write(
        config,
        directory,
        lambda: elaborated(ray_caster_module, **module_ports(config), config=config),
        partial(write_take_home, config, prefix),
        prefix,
    )


def write_scene_system(config: Configuration, scene: Scene, directory: Path) -> list[Path]:
    """Write `scene_system`, which has no processor, with a scene of no more rectangles than the hardware.

    Raises:
        UserError: the configuration has another bus than Avalon-MM.
    """
    need_avalon(config, "a system without a processor")
    return _write(
        config, directory, lambda: elaborated(scene_system, **scene_system_ports(config), config=config, scene=scene)
    )


def write_system(config: Configuration, directory: Path, program: str = PROGRAM_FILE) -> list[Path]:
    """Write `ray_caster_system`; PicoRV32 is among the files as it was given.

    Args:
        config: what to generate.
        directory: where to.
        program: the file with the words of the program, in hexadecimal, which simulators open where they run, and
            synthesis where it reads the Verilog.

    Raises:
        UserError: PicoRV32 is not installed, or the configuration has another bus than Avalon-MM.
    """
    need_avalon(config, "a system with a processor")
    return _write(
        config,
        directory,
        lambda: elaborated(ray_caster_system, **system_ports(config), config=config, program=program),
    )


def write_dvi_encoder(config: Configuration, directory: Path) -> list[Path]:
    """Write `dvi_encoder`, which turns a VGA output of 8 bits a channel into a DVI link; config names the files."""
    return _write(config, directory, lambda: elaborated(dvi_encoder, **dvi_ports()))


def design_states(config: Configuration) -> dict[tuple[str, str], dict[int, str]]:
    """The enumerated signals of `ray_caster_module`; see `raycaster.convert.inside.state_names`."""
    with elaboration():
        return state_names(elaborated(ray_caster_module, **module_ports(config), config=config))


def _write(
    config: Configuration,
    directory: Path,
    elaborate: Callable[[], _Block],
    complete: Callable[[list[Module], Path], None] | None = None,
    prefix: str = "",
) -> list[Path]:
    with replaced(directory) as written:
        with elaboration():
            modules = convert_hierarchy(elaborate(), written, _header(config), prefix)
        if complete:
            complete(modules, written)
    return [directory / module.path.name for module in modules]


def _header(config: Configuration) -> str:
    return f"// RayCaster: {{module}}\n// Configuration: {config.name}\n// SPDX-License-Identifier: MIT"
