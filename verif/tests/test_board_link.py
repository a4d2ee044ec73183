# SPDX-License-Identifier: MIT
"""Rooms sent to a board, and walks through them: over a pseudo-terminal to a model of the registers at its end."""

from __future__ import annotations

import os
import pty
import re
import threading
import time
import tty
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import pytest
from conftest import SMALL_SCENE, refused

from raycaster.buses import USUAL_BAUD
from raycaster.configuration import Configuration
from raycaster.design.decide import configure
from raycaster.errors import UserError
from raycaster.play import board_walk, send
from raycaster.play.board import Board
from raycaster.play.walk import Walker
from raycaster.program import scene_words
from raycaster.registers import register_map
from raycaster.rtl.bus.avalon_interface import engine_word, size_word, table_word, version_word
from raycaster.scene import find_scene, load_scene
from raycaster.serial_frames import FLAG, LEAD, FrameDecoder, access, framed, last_access, writes

SPAN, LARGE = (
    configure(engine="span", rectangles=count, turn=True, light=True, materials=True, patterns=True, bus="uart")
    for count in (12, 128)
)


class Device:
    """The registers of a design at the other end of a line, as docs/integration.md describes them.

    Attributes:
        port: name of the serial port.
        written: words and their addresses in the order of writing.
        deaf: number of frames that are dropped.
        baud: bits per second, if bytes take their time on the line.
        heard: all bytes that came.
        draws: what a read of the registers finds of frames; by default, one more was drawn each time.
    """

    def __init__(
        self,
        config: Configuration,
        deaf: int = 0,
        draws: Mapping[str, Mapping[str, int]] | None = None,
        baud: float = float("inf"),
    ):
        self._end, other = pty.openpty()
        tty.setraw(other)
        self.port, self.written, self.deaf, self.heard = os.ttyname(other), [], deaf, bytearray()
        self._byte_time = 10 / baud
        registers = register_map(*config.map)
        words = {"id": registers["id"].reset, "version": version_word(config), "engine": engine_word(config),
                 "size": size_word(config), "table": table_word(config)}  # fmt: skip
        words |= {name: registers[name].pack(**fields) for name, fields in (draws or {}).items()}
        self._words = {registers[name].address: word for name, word in words.items()}
        self._counts = registers["frames.counts"].address if draws is None and config.facts.whole_frames else None
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        decoder = FrameDecoder()
        while True:
            data = os.read(self._end, 256)
            self.heard += data
            time.sleep(self._byte_time * len(data))
            for words in decoder.feed(data):
                self.deaf -= 1
                if self.deaf < 0:
                    # Half an answer to someone else comes first, and a whole one.
                    answer = self._carried_out(words)
                    for byte in framed([7, 8])[:6] + framed([7] * len(answer)) + framed(answer):
                        os.write(self._end, bytes([byte]))
                        time.sleep(self._byte_time)

    def _carried_out(self, words: list[int]) -> list[int]:
        at = 0
        while at < len(words):
            first, at = words[at], at + 1
            address, count = first & 0xFFFF, first >> 16 & 0x3FF
            if not first >> 31:
                if self._counts is not None:
                    self._words[self._counts] = self._words.get(self._counts, 0) + 1
                return [first, *(self._words.get(address + number, 0) for number in range(count))]
            for number in range(count):
                self.written.append((address + number, words[at + number]))
            at += count
        return [first]


def test_frames():
    """A frame as the page on integration gives it, every odd byte, and bytes that are no frame."""
    assert framed(access(0, read=1)) == bytes.fromhex("7E 00 00 01 00 5D EE 5F 38 7E")
    words = [0x7E7D_7C7F, 0x7D7E_7D7E, 0, 0xFFFF_FFFF]
    data = framed(words)
    assert FLAG not in data[1:-1]
    for noise in (b"", b"\x12\x7d", data[:9]):
        assert list(FrameDecoder().feed(noise + data + data[:-1])) == [words]
    assert list(FrameDecoder().feed(data[:5] + bytes([data[5] ^ 1]) + data[6:])) == []
    assert list(FrameDecoder().feed(data[:-1] + b"\x7d" + data[-1:])) == [], "an abort"
    for address, count in ((0, 1024), (1 << 16, 1)):
        with pytest.raises(ValueError, match="does not fit a frame"):
            access(address, read=count)
    decoder, parts = FrameDecoder(), [data[at : at + 3] for at in range(0, len(data), 3)]
    assert [found for part in parts for found in decoder.feed(part)] == [words]
    plain = b"".join(word.to_bytes(4, "little") for word in words)
    sent = plain + zlib.crc32(plain).to_bytes(4, "little")
    assert re.sub(rb"\x7d(.)", lambda pair: bytes([pair[1][0] ^ 0x20]), data[1:-1], flags=re.DOTALL) == sent


def test_a_room_is_a_frame():
    """Each word is written once, and the one that commits is last."""
    for config in (SPAN, configure(engine="span", rectangles=128), configure(engine="exact")):
        pairs = scene_words(load_scene(SMALL_SCENE), config)
        words, found = writes(pairs), []
        assert last_access(words) == access(*[pairs[-1][0]], [0])[0]
        while words:
            first, *words = words
            count = first >> 16 & 0x3FF
            found += [((first & 0xFFFF) + number, word) for number, word in enumerate(words[:count])]
            words = words[count:]
        assert sorted(found) == sorted(pairs)
        assert found[-1] == pairs[-1]


@pytest.mark.parametrize(("config", "deaf", "baud"), [(SPAN, 0, 2400), (LARGE, 2, USUAL_BAUD)])
def test_send(capsys, config, deaf, baud):
    """All words of a room are written, also over a slow line; a frame that is not answered is sent again."""
    device = Device(config, deaf, baud=baud)
    path = find_scene("lamplight")
    send.main([str(path), "--port", device.port, "--baud", str(baud)])
    status = register_map(*config.map)["frames.status"]
    assert device.written.pop() == (status.address, status.pack(list_full=1)), "from the scene before"
    words = scene_words(load_scene(path), config)
    assert sorted(device.written) == sorted(words)
    assert deaf or device.heard.count(framed(writes(words))) == 1, "the time on the line was waited for"
    assert 2 * device.heard.count(bytes([LEAD, FLAG])) == device.heard.count(FLAG)
    assert re.search(
        rf"lamplight\.toml: sent, \d+ of at most {config.rectangles} rectangles, span engine\n", capsys.readouterr().out
    )


@contextmanager
def typed(text: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let standard input be a terminal in which a text is typed."""
    end, other = pty.openpty()
    with open(other) as terminal:
        monkeypatch.setattr("sys.stdin", terminal)
        timer = threading.Timer(1, lambda: os.write(end, text.encode()))
        timer.start()
        yield
        timer.join()


def test_walk(monkeypatch, capsys):
    """Each key moves the camera as on a VT100, whose arrows are A up, B down, C right and D left."""
    device, path = Device(SPAN), find_scene("lamplight")
    # Opposite keys are pressed unequally often, so that exchanged keys end elsewhere.
    with typed("wwwsddarrf\x1b[A\x1b[A\x1b[B\x1b[C\x1b[C\x1b[Dxq", monkeypatch):
        board_walk.main([str(path), "--port", device.port])
    walker = Walker(load_scene(path), SPAN)
    expected = sorted(walker.load())
    assert sorted(device.written[: len(expected)]) == expected
    walked = ("forward", "forward", "forward", "back", "right", "right", "left", "rise", "rise", "sink")
    for held in (*walked, "look up", "look up", "look down", "turn right", "turn right", "turn left"):
        walker.move({held})
    last = writes(walker.writes())
    assert [word for _, word in device.written[-len(walker.writes()) :]] == [
        word for at, word in enumerate(last) if at not in heads(last)
    ]
    assert "q ends" in capsys.readouterr().out


def heads(words: list[int]) -> set[int]:
    """Return the places of the first words of writes."""
    found, at = set(), 0
    while at < len(words):
        found.add(at)
        at += 1 + (words[at] >> 16 & 0x3FF)
    return found


def refuses(config: Configuration, scene: str, *, words: tuple[str, ...] = ()) -> str:
    device = Device(config)
    said = refused(send.main, str(find_scene(scene)), "--port", device.port, *words)
    assert device.written == []
    return said


def test_a_room_that_does_not_fit():
    few = configure(engine="span", rectangles=2, bus="uart")
    assert "rectangles, but the hardware holds 2" in refuses(few, "boxes")
    assert re.search(r"reflections: 2, but the design on /dev/\S+ computes at most 1; build it with --reflections 2\n$",
                     refuses(configure(engine="span", reflections=1), "facing_mirrors"))  # fmt: skip
    plain = configure(engine="span", rectangles=32, turn=True, materials=True, patterns=True)
    assert re.search(r"needs a light, which the design on /dev/\S+ lacks; build it with --light 1\n$",
                     refuses(plain, "evening"))  # fmt: skip


def test_a_room_that_is_not_drawn(monkeypatch):
    """The command fails, as the board still shows the room before."""
    monkeypatch.setattr("raycaster.play.board.SHOWN", 0.1)
    for draws, said in (
        ({"frames.status": {"list_full": 1}}, "has more runs than the list of the design on "),
        ({"frames.status": {"late": 1}}, "has drawn no frame for "),
        ({"control": {"commit": 1}}, "has drawn no frame for "),
    ):
        assert said in refused(send.main, "boxes", "--port", Device(SPAN, draws=draws).port)


def test_no_board(monkeypatch, tmp_path):
    """One line says what is missing."""
    monkeypatch.setattr("raycaster.play.board.PATIENCE", 0.02)
    assert re.search(r"port: \S+nothing: there is no such port; those that were found: ",
                     refused(send.main, "boxes", "--port", str(tmp_path / "nothing")))  # fmt: skip
    # What is sent comes back: that is no answer.
    assert "port: no answer from loop:// at 9600 baud; " in refused(
        send.main, "boxes", "--port", "loop://", "--baud", "9600"
    )
    device, engine = Device(SPAN), register_map(1)["engine"]
    device._words[engine.address] |= engine.fields["fixed"].mask
    assert "has its scene built in; make it without " in refused(send.main, "boxes", "--port", device.port)
    for register, word in (("id", 1), ("version", 2 << 16)):
        other = Device(SPAN)
        other._words[register_map(1)[register].address] = word
        assert "is no ray tracer of this version" in refused(send.main, "boxes", "--port", other.port)
    assert "walk: takes keys from a terminal" in refused(board_walk.main, "boxes", "--port", "loop://")
    monkeypatch.setattr("raycaster.play.board_walk.termios", None)
    assert "walk: needs a terminal of Linux or macOS" in refused(board_walk.main, "boxes", "--port", "loop://")


def test_no_permission(monkeypatch):
    def denied(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("serial.serial_for_url", denied)
    with pytest.raises(UserError, match=r"^port: /dev/ttyUSB0: permission denied; join the group "):
        Board("/dev/ttyUSB0")
