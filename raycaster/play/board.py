# SPDX-License-Identifier: MIT
"""A board on a serial port, whose design has the bus uart."""

from __future__ import annotations

import errno
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import serial
from serial.tools import list_ports

from raycaster.buses import USUAL_BAUD
from raycaster.complaints import as_typed
from raycaster.configuration import FEATURES, Configuration, ConfigurationError
from raycaster.design.decide import configure
from raycaster.design.options import CommandParser
from raycaster.errors import UserError
from raycaster.registers import register_map
from raycaster.rtl.engines import ENGINES
from raycaster.scene import Scene, load_scene
from raycaster.serial_frames import LEAD, WRITE_BIT, FrameDecoder, access, count_of, framed, last_access, writes

PATIENCE = 0.3
"""Seconds for which an answer may take, besides the time on the line."""

ATTEMPTS = 3
"""Number of times that a frame is sent before the board is said not to answer."""

SHOWN = 3.0
"""Seconds within which a new scene must be drawn."""


class Board:
    """A design at a serial port, whose registers are read and written.

    Args:
        port: name of the port, or a URL of pyserial.
        baud: bits per second.

    Attributes:
        config: a design with the same registers and features.

    Raises:
        UserError: there is no such port or no such design, in one line.
    """

    def __init__(self, port: str, baud: int = USUAL_BAUD):
        self.port, self._baud = port, baud
        try:
            self._line = serial.serial_for_url(port, baud, timeout=0.01)
        except (serial.SerialException, ValueError, OSError) as error:
            raise UserError(f"port: {port}: {_reason(error)}") from None
        self._decoder = FrameDecoder()
        self.config = self._identified()
        self._registers = register_map(*self.config.map)

    def request(self, words: Sequence[int]) -> list[int]:
        """Send a frame, and return the words that it reads.

        Raises:
            UserError: there is no answer.
        """
        first = last_access(words)
        length = 1 + (0 if first >> WRITE_BIT else count_of(first))
        data = bytes([LEAD]) + framed(words)
        try:
            for _ in range(ATTEMPTS):
                self._line.write(data)
                end = time.monotonic() + PATIENCE + 10 * (len(data) + 8 * length + 20) / self._baud
                while time.monotonic() < end:
                    for answer in self._decoder.feed(self._line.read(max(1, self._line.in_waiting))):
                        if answer[:1] == [first] and len(answer) == length:
                            return answer[1:]
        except (serial.SerialException, OSError) as error:
            raise UserError(f"port: {self.port}: {_reason(error)}") from None
        raise UserError(
            f"port: no answer from {self.port} at {self._baud} baud; load a bitstream made with "
            f"{as_typed('bus', 'uart')} and this {as_typed('baud', self._baud)}, and check the cable"
        )

    def _identified(self) -> Configuration:
        registers = register_map(1)
        words = self.request(access(0, read=registers["table"].address + 1))
        known = {
            name: registers[name].unpack(words[registers[name].address])
            for name in ("id", "version", "engine", "size", "table")
        }
        engine = known["engine"]
        names = [name for name, each in ENGINES.items() if each.facts.code == engine["engine"]]
        right = {"id": "magic", "version": "major"}
        if not names or any(known[name][field] != registers[name].fields[field].reset for name, field in right.items()):
            raise UserError(f"port: what answers on {self.port} is no ray tracer of this version")
        if engine["fixed"]:
            raise UserError(
                f"port: the design on {self.port} has its scene built in; make it without {as_typed('fix')}"
            )
        held = known["table"]["rectangles"] or known["size"]["rectangles"]
        features = {name: bool(engine[name]) for name in FEATURES}
        try:
            return configure(
                engine=names[0], rectangles=held, reflections=engine["reflections"], allow_underrun=True, **features
            )
        except ConfigurationError as error:
            raise UserError(f"port: the design on {self.port} is none of this version: {error}") from None

    def scene(self, path: Path) -> Scene:
        """Read a scene file that the design can show.

        Raises:
            UserError: the file is wrong, or the design lacks something that the scene needs, in one line.
        """
        scene = load_scene(path, self.config.capacity)
        for feature in scene.lacks(self.config.features):
            raise UserError(
                f"{path}: needs {FEATURES[feature]}, which the design on {self.port} lacks; build it with "
                f"{as_typed(feature, 1)}"
            )
        if scene.reflections > self.config.most_reflections:
            raise UserError(
                f"{path}: reflections: {scene.reflections}, but the design on {self.port} computes at most "
                f"{self.config.most_reflections}; build it with {as_typed('reflections', scene.reflections)}"
            )
        return scene

    def write(self, pairs: Iterable[tuple[int, int]]) -> None:
        """Write words to word addresses, in one frame; the last pair commits."""
        self.request(writes(pairs))

    def read(self, name: str) -> dict[str, int]:
        """Read a register, and return its fields."""
        register = self._registers[name]
        return register.unpack(self.request(access(register.address, read=1))[0])

    def show(self, pairs: Iterable[tuple[int, int]]) -> None:
        """Write the words of a scene; wait until a frame of it is drawn, if the design draws whole frames.

        Raises:
            UserError: no frame of it is drawn, so the board shows what it showed before.
        """
        self.write(pairs)
        if not self.config.facts.whole_frames:
            return
        self._wait(lambda: not self.read("control")["commit"])
        # A frame of the scene before may have set it.
        status = self._registers["frames.status"]
        self.write([(status.address, status.pack(list_full=1))])
        drawn = self.read("frames.counts")["drawn"]
        self._wait(lambda: self._abandons() or self.read("frames.counts")["drawn"] != drawn)
        if self._abandons():
            raise UserError(
                f"port: a frame of this scene has more runs than the list of the design on {self.port}, which still "
                f"shows the scene before; build it with a longer {as_typed('list')}, see `raycaster scenes`"
            )

    def _abandons(self) -> bool:
        return bool(self.read("frames.status")["list_full"])

    def _wait(self, holds: Callable[[], bool]) -> None:
        end = time.monotonic() + SHOWN
        while not holds():
            if time.monotonic() > end:
                raise UserError(
                    f"port: the scene was sent, but the design on {self.port} has drawn no frame for {SHOWN:.0f} s"
                )


def _reason(error: Exception) -> str:
    number = getattr(error, "errno", None)
    if number == errno.EACCES:
        return "permission denied; join the group that owns it, usually dialout, or run it as another user"
    if number == errno.ENOENT:
        others = ", ".join(sorted(one.device for one in list_ports.comports())) or "none"
        return f"there is no such port; those that were found: {others}"
    return str(error)


def add_port_options(parser: CommandParser) -> None:
    """Add `--port` and `--baud`."""
    parser.add_argument("--port", required=True, help="serial port of the board, such as /dev/ttyUSB0 or COM3")
    # Help leaves out what has the name of a design's option.
    parser.add_argument(
        "--baud", dest="rate", type=int, default=USUAL_BAUD, help="bits per second, as in the design (%(default)s)"
    )
