# SPDX-License-Identifier: MIT
"""The game, compiled for the host: its pictures, its rules and the recorded demo."""

from __future__ import annotations

import ctypes
import hashlib
import json
import random
from collections import Counter
from collections.abc import Iterator

import numpy as np
import pytest
from conftest import KEPT, compare_kept
from host_software import (
    CORNER,
    FIRE,
    Error,
    Frame,
    Game,
    Phase,
    Session,
    compile_library,
    enumeration,
    members,
)

from raycaster.design.decide import configure
from raycaster.golden.rays import primary_slopes
from raycaster.registers import register_map
from raycaster.scene import Camera
from raycaster.sim.register_model import LiveScene
from raycaster.sw.play_script import DEMO, dump, load

Entry = enumeration("game_entry")
COURT = {"x": (44, 281), "y": (89, 423), "z": (0, 264)}
"""Bounds of the court; the ball leaves it at the front."""

MARGIN = {"x": 0, "y": 13, "z": 13}
"""Least distance of the ball's centre from the walls."""

LIVES = 3


@pytest.fixture(scope="module")
def library(tmp_path_factory) -> ctypes.CDLL:
    return compile_library(tmp_path_factory.mktemp("game"), "raycaster.c", "game/game.c")


@pytest.fixture
def attract(library) -> Session:
    """Session that nobody plays."""
    return Session(library)


@pytest.fixture
def session(attract) -> Session:
    """Session in which fire was pressed."""
    assert attract.step(FIRE) == {"STARTED"}
    return attract


@pytest.fixture(scope="module")
def demo(library) -> list[tuple[Frame, Game]]:
    """Each frame of the demo, and the game after it; played once for all tests."""
    session = Session(library)
    return [(frame, Game.from_buffer_copy(session.game)) for frame in session.play(load(DEMO))]


def check_in_court(game: Game) -> None:
    for axis, (low, high) in COURT.items():
        assert low + MARGIN[axis] <= getattr(game.ball, axis) / 256 <= high - MARGIN[axis]
    assert 0 <= game.lives <= LIVES
    assert 1 <= game.level <= 9


def scene_of(live: LiveScene) -> tuple:
    """Return the part of a live scene that is drawn, in a form that can be compared."""
    shown = live.rectangles.enabled
    rectangles = (live.rectangles.corners[shown].tolist(), live.rectangles.colours[shown].tolist(), shown.tolist())
    return live.run, live.reflections, live.background, live.camera, rectangles


def wild(count: int) -> Iterator[int]:
    """Yield random buttons, each held for some frames."""
    generator = random.Random(1)
    for _ in range(count):
        yield from [generator.getrandbits(5)] * (1 + generator.getrandbits(4))


def clever(game: Game, software: ctypes.CDLL) -> Iterator[int]:
    """Yield the buttons of a good player, who sees every level."""
    yield FIRE
    while game.level < 9:
        yield software.game_autoplay(game)


def plain(value: object) -> object:
    """Return a value of C or numpy in a form that JSON takes."""
    if isinstance(value, ctypes.Structure):
        return members(value)
    return list(value) if isinstance(value, ctypes.Array) else int(value)


def test_games_are_played_as_they_were_kept(library):
    """Every value of the game in every frame, and the scene, in some games of each 250th: see `kept/games.txt`."""
    lost = [*[0, FIRE] * 20, *[CORNER] * 900, *[0, FIRE] * 200]
    lines = []
    for name in ("demo", "lost", "wild", "nobody", "clever"):
        session, found = Session(library), hashlib.sha256()
        game, happened = session.game, Counter()
        buttons = {
            "demo": load(DEMO), "lost": lost, "wild": wild(400), "nobody": [0] * 9000,
            "clever": clever(game, library),
        }[name]  # fmt: skip
        if name in ("demo", "lost"):
            frames = ((frame.events, scene_of(frame.live)) for frame in session.play(buttons))
        else:
            frames = ((session.step(held), ()) for held in buttons)
        for number, (events, scene) in enumerate(frames, 1):
            if number % 250 == 0:
                assert session.draw() == Error.OK
            found.update(json.dumps([members(game), sorted(events), scene], default=plain).encode())
            happened.update(events)
            if number % 250 == 0:
                counts = ", ".join(f"{count} {event}" for event, count in sorted(happened.items()))
                lines.append(f"{name} {number}: level {game.level}, score {game.score}, lives {game.lives}; {counts}; "
                             f"{found.hexdigest()[:12]}\n")  # fmt: skip
    compare_kept(KEPT / "games.txt", "".join(lines))


def test_a_step_off_the_demo_still_plays_well(library):
    """The game counts frames from fire, so hardware that starts some frames later plays the same game."""
    scores = set()
    for late in (0, 1, 17):
        other = Session(library)
        for buttons in [0] * late + list(load(DEMO)):
            other.step(buttons)
        scores.add((other.game.score, other.game.level, other.game.lives))
    assert len(scores) == 1


def test_writing_changes_equals_writing_all(attract, demo):
    """Writing only the changes gives the same frames as writing the whole table."""
    for frame, game in demo[:480:60]:
        attract.game = Game.from_buffer_copy(game)
        attract.game.drawn = False
        assert attract.draw() == Error.OK
        assert scene_of(frame.live) == scene_of(attract.device.shown())


@pytest.mark.parametrize("seed", [0, 1, 7, 0xFFFFFFFF])
def test_wild_buttons_do_no_harm(library, seed):
    """With any buttons pressed, every rectangle is in the world, has a plane and is drawn; see `Session.play`."""
    session = Session(library, seed)
    generator = random.Random(seed)
    for _ in range(150):
        for _ in session.play(generator.randrange(1, 20) * [generator.getrandbits(5)]):
            check_in_court(session.game)


def test_a_game_starts_the_same_whatever_came_before(library):
    """Only the random numbers go on."""
    games = []
    for spoilt in (0, 1, 3):
        session = Session(library)
        session.game.random, session.game.phase, session.game.age = 77, Phase.OVER if spoilt else Phase.SERVE, 61
        for name in ("lives", "level", "tiles", "score", "sway", "alarm", "turn"):
            setattr(session.game, name, getattr(session.game, name) + spoilt)
        session.game.racket = session.game.velocity = type(session.game.racket)(spoilt, spoilt, spoilt)
        assert session.step(FIRE) == {"STARTED"}
        games.append(bytes(session.game))
    assert games[0] == games[1] == games[2]


def test_what_is_left_out_alone_is_not_drawn(session):
    """The ball, which is left out at the end, need not have moved in that frame."""
    for phase in (Phase.PAST, Phase.OVER, Phase.PAST):
        session.game.phase = phase
        assert session.draw() == Error.OK
        assert session.device.shown().rectangles.enabled[Entry.BALL] == (phase != Phase.OVER)


def test_the_player_looks_after_the_ball(library):
    """A camera that can turn follows the ball by one degree per frame and never sees past the court's front."""
    config = configure(engine="exact", screen="tiny", turn=True)
    session = Session(library, config=config)
    basis = {4 * register_map(config.rectangles)[name].address for name in ("forward", "right", "up")}
    edges = primary_slopes(configure(engine="exact").screen_geometry)[0, [0, -1]]
    turns, wanted = [0], 0
    for number, frame in enumerate(session.play(load(DEMO))):
        turns.append(session.game.turn)
        camera = Camera(position=frame.live.camera, yaw=float(turns[-1]))
        assert frame.live.basis == camera.basis
        changed = number == 0 or turns[-1] != turns[-2]
        assert len({offset for offset, _ in frame.written} & basis) == (3 if changed else 0)
        front = frame.live.rectangles.low[Entry.FLOOR][0]
        for slope in edges @ np.array(frame.live.basis):
            assert COURT["y"][0] < camera.position[1] + slope[1] * front / slope[0] < COURT["y"][1]
        # The camera follows the ball's position in the previous frame.
        if "STARTED" not in frame.events:
            assert turns[-1] - turns[-2] == np.sign(wanted - turns[-2])
        aside = session.game.ball.y // 256 - sum(COURT["y"]) // 2
        wanted = int(np.clip(int(aside / 40), -3, 3))
    assert (min(turns), max(turns)) == (-3, 3)


def test_a_table_that_is_too_small(library):
    session = Session(library, config=configure(engine="exact", screen="tiny", rectangles=11))
    written = []
    for _ in range(2):
        session.registers.written.clear()
        assert session.draw() == Error.NO_SUCH_RECTANGLE
        written.append(list(session.registers.written))
    assert written[0] == written[1] != [], "after an error everything is written again"


def test_a_script_holds_buttons_until_the_next_line(tmp_path):
    path = tmp_path / "script.txt"
    path.write_text("# a comment\n\n2 fire  # and another\n3\n4 left up up\n6 end\n")
    assert load(path) == (0, 0, 16, 0, 5, 5)
    path.write_text(dump(load(path)))
    assert load(path) == (0, 0, 16, 0, 5, 5)
