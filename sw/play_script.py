# SPDX-License-Identifier: MIT
"""Read and write recorded games: the buttons held in each frame."""

from __future__ import annotations

from pathlib import Path

from raycaster.errors import UserError
from raycaster.memory_map import BUTTON_NAMES, held_bits

DEMO = Path(__file__).parent / "game" / "demo.txt"


MOST_FRAMES = 1_000_000
"""Most frames in a script, hours of play."""


class PlayScriptError(UserError):
    """A play script that is rejected; the text names the file, the line, and what was expected."""


def load(path: Path | str) -> tuple[int, ...]:
    """Read a play script.

    Each line has a frame number and the names of the buttons held from that frame on; the last line has the number of
    frames and `end`. A `#` starts a comment. Frame numbers begin at 0 and rise; before the first line no button is
    held.

    Args:
        path: the text file.

    Returns:
        The buttons held in each frame, as bits in the order of `BUTTON_NAMES`.

    Raises:
        PlayScriptError: the file cannot be read, or a line is wrong; one line says where and what was expected.
    """
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise PlayScriptError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise PlayScriptError(f"{path}: is not UTF-8 text") from None
    frames: list[int] = []
    held = 0
    previous = -1
    ended = False
    for number, line in enumerate(lines, 1):
        words = line.partition("#")[0].split()
        if not words:
            continue
        place = f"{path}: line {number}"
        if ended:
            raise PlayScriptError(f"{place}: nothing may follow the end")
        first, *names = words
        # Length before value, as Python refuses to read thousands of digits.
        if not (first.isascii() and first.isdigit() and len(first) < 20 and int(first) <= MOST_FRAMES):
            raise PlayScriptError(f"{place}: expected a frame number up to {MOST_FRAMES}, got {first[:20]}")
        frame = int(first)
        if frame <= previous:
            raise PlayScriptError(f"{place}: frame {frame} must come after {previous}")
        frames += [held] * (frame - len(frames))
        previous = frame
        if names == ["end"]:
            ended = True
            continue
        for name in names:
            if name not in BUTTON_NAMES:
                raise PlayScriptError(f"{place}: expected a button ({', '.join(BUTTON_NAMES)}), got {name}")
        held = held_bits(names)
    if not ended:
        raise PlayScriptError(f"{path}: expected a last line with the number of frames and the word end")
    if not frames:
        raise PlayScriptError(f"{path}: expected at least one frame, got none")
    return tuple(frames)


def dump(frames: tuple[int, ...]) -> str:
    """Return the text of a play script, without comments; `load` reads the same frames from it."""
    lines = []
    held = 0
    for frame, buttons in enumerate(frames):
        if buttons != held:
            names = [name for bit, name in enumerate(BUTTON_NAMES) if buttons >> bit & 1]
            lines.append(" ".join([str(frame), *names]))
            held = buttons
    return "\n".join([*lines, f"{len(frames)} end"]) + "\n"
