# SPDX-License-Identifier: MIT
"""The game, compiled for the host: its pictures, its rules and the recorded demo."""

from __future__ import annotations

import ctypes
import random
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
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
)

from raycaster.configuration import configure
from raycaster.golden.exact import ExactModel
from raycaster.golden.rays import primary_slopes
from raycaster.memory_map import BUTTON_NAMES
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


def test_the_demo_is_a_good_game(demo):
    assert len(demo) >= 150
    happened = Counter(event for frame, _ in demo for event in frame.events)
    assert happened["STARTED"] == 1
    assert happened["TILE"] >= 4
    assert happened["LEVEL"]
    assert not happened["MISSED"]
    _, end = demo[-1]
    assert (end.attract, end.lives) == (False, LIVES)


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


def test_attract_mode_plays_by_itself_for_ever(attract):
    happened, levels = Counter(), set()
    for _ in range(20_000):
        happened.update(attract.step(0))
        levels.add(attract.game.level)
        check_in_court(attract.game)
    assert attract.game.attract
    assert "ENDED" not in happened
    assert happened["RETURNED"] > 20 * happened["MISSED"]
    assert levels == {1, 2, 3, 4}


def test_a_good_player_sees_every_level(session):
    speeds = {}
    for _ in range(60_000):
        session.step(session.software.game_autoplay(session.game))
        if session.game.phase == Phase.RALLY:
            speeds.setdefault(session.game.level, abs(session.game.velocity.x))
        if session.game.attract:
            break
    assert sorted(speeds) == list(range(1, len(speeds) + 1))
    assert len(speeds) >= 7
    assert all(slow < fast for slow, fast in pairwise(speeds.values()))


@pytest.mark.parametrize(("level", "sways"), [(1, (0, 0)), (2, (135, 0)), (3, (131, 96)), (9, (107, 72))])
def test_the_veil_sways_from_level_to_level(session, level, sways):
    """From side to side from level 2 on, and up and down from level 3 on, as far as the walls."""
    session.game.level, seen = level, []
    for _ in range(4 * max(*sways, 1)):
        session.game.phase = Phase.PAST  # the ball does not reach anything
        session.game.ball.x = 256 * COURT["x"][1]
        session.step(0)
        seen.append((session.game.veil.y - 256, session.game.veil.z - 132))
    assert [(min(way), max(way)) for way in zip(*seen, strict=True)] == [(-sway, sway) for sway in sways]
    assert all(abs(now - then) <= 1 for pair in pairwise(seen) for then, now in zip(*pair, strict=True))


@pytest.mark.parametrize(("alone", "level", "after"), [(False, 8, 9), (False, 9, 9), (True, 3, 4), (True, 4, 1)])
def test_the_last_level_stays_or_attract_mode_starts_over(session, alone, level, after):
    game = session.game
    game.attract, game.level, game.tiles, game.phase = alone, level, 3, Phase.RALLY
    for axis in "xyz":
        setattr(game.ball, axis, 256 * getattr(game.target, axis))
    assert session.step(0) == {"TILE", "LEVEL"}
    assert (game.level, game.tiles) == (after, 0)


def test_attract_mode_loses_no_lives(attract):
    missed = 0
    while missed <= LIVES:
        attract.game.racket.y = COURT["y"][0]
        assert attract.game.lives == LIVES
        missed += "MISSED" in attract.step(0)


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


def test_lives_are_lost_and_the_game_ends(session):
    assert not session.game.attract
    missed = 0
    while session.game.phase != Phase.OVER:
        missed += "MISSED" in session.step(CORNER)
        assert session.game.lives == LIVES - missed
    assert missed == LIVES
    frames = 0
    while not session.game.attract:
        assert session.step(0) == set()
        frames += 1
    assert (frames, session.game.lives) == (300, LIVES)


def test_fire_starts_anew_but_not_in_haste(session):
    while session.game.phase != Phase.OVER:
        session.step(CORNER)
    for held in 30 * (0, FIRE):
        assert session.step(held) == set()
        assert session.game.phase == Phase.OVER
    assert session.step(FIRE) == set(), "it is still held"
    session.step(0)
    assert session.step(FIRE) == {"STARTED"}
    assert (session.game.score, session.game.level, session.game.lives) == (0, 1, LIVES)


def test_the_ball_is_served_by_itself(session):
    phases = []
    for _ in range(45):
        session.step(0)
        phases.append(session.game.phase)
    assert phases == [*[Phase.SERVE] * 44, Phase.RALLY]


def test_fire_serves(session):
    for buttons, phase in ((0, Phase.SERVE), (FIRE, Phase.RALLY)):
        # Fire is still held from the start, and serves only when it is pressed again.
        for held in (FIRE, buttons):
            session.step(held)
        assert session.game.phase == phase


@pytest.mark.parametrize(
    ("button", "axis", "sign", "edge"),
    [("left", "y", -1, 89 + 32), ("right", "y", 1, 423 - 32), ("up", "z", 1, 264 - 25), ("down", "z", -1, 25)],
)
def test_buttons_move_the_racket(session, button, axis, sign, edge):
    button = BUTTON_NAMES.index(button)
    places = [getattr(session.game.racket, axis)]
    for held in (1 << button, 0b1111, *200 * [1 << button]):
        session.step(held)
        places.append(getattr(session.game.racket, axis))
    assert np.sign(places[1] - places[0]) == sign
    assert places[-2:] == [edge, edge], "the racket's edge stops at the wall"


def test_bars_show_lives_and_tiles(demo):
    bars = [Entry.LIVES_BAR, Entry.SCORE_BAR]
    shown = set()
    for frame, game in demo:
        if not game.attract:
            live = frame.live.rectangles
            lengths = (live.high[bars, 0] - live.low[bars, 0]) * live.enabled[bars]
            assert lengths.tolist() == [60 * game.lives, 45 * game.tiles]
            shown.add(game.tiles)
    assert shown == {0, 1, 2, 3}


def test_the_score_follows_from_the_events(demo):
    score, level = 0, 1
    for frame, game in demo:
        score += ("RETURNED" in frame.events) + 10 * level * ("TILE" in frame.events)
        level += "LEVEL" in frame.events
        assert (game.score, game.level) == (score, level)


def test_hit_rectangles_flash(demo):
    for event, entry in (("RETURNED", Entry.RACKET), ("TILE", Entry.TARGET)):
        white = 0
        for frame, _ in demo:
            is_white = frame.live.rectangles.colours[entry].tolist() == [255, 255, 255]
            assert is_white or event not in frame.events
            white = white + 1 if is_white else 0
            assert white < 10


def test_a_miss_turns_the_walls_red_and_the_end_hides_the_ball(attract):
    frames = list(attract.play([FIRE] + [CORNER] * 700))
    missed = [number for number, frame in enumerate(frames) if "MISSED" in frame.events]
    over = next(number for number, frame in enumerate(frames) if "ENDED" in frame.events)
    for number, frame in enumerate(frames[: over + 200]):
        red, green, blue = frame.live.rectangles.colours[Entry.BACK_WALL]
        recent = any(number - 24 < one <= number for one in missed)
        assert (red > 2 * max(green, blue)) == (recent or number >= over)
        ball, lives = frame.live.rectangles.enabled[[Entry.BALL, Entry.LIVES_BAR]]
        assert (ball, lives) == (number < over, sum(one <= number for one in missed) < LIVES)


def test_mirrors_show_what_the_veil_hides(demo):
    """In some frames only reflected rays meet the ball."""
    slopes = primary_slopes(configure(engine="exact", screen="tiny").screen_geometry).reshape(-1, 3)
    ball = Entry.BALL
    met = set()
    for frame, _ in demo[80:220:10]:
        live = frame.live
        first, second = ExactModel().trace(live.rectangles, live.camera, live.background, slopes, 1).winners
        met.add(((first == ball).any(), (second == ball).any()))
    assert (False, True) in met
    assert met & {(True, False), (True, True)}


def test_no_ray_meets_an_edge_of_the_court(session):
    """This holds for every camera position that the racket leads to."""
    slope = primary_slopes(configure(engine="exact").screen_geometry).reshape(-1, 3)
    walls = [Entry.FLOOR, Entry.CEILING, Entry.LEFT_WALL, Entry.RIGHT_WALL, Entry.BACK_WALL]
    eyes = set()
    for frame in session.play([0b0001] * 60 + [0b0010] * 120):
        eyes.add(frame.live.camera)
    assert len({y for _, y, _ in eyes}) > 20
    for eye in eyes:
        corners = frame.live.rectangles.corners[walls]
        low, high = (edge - np.array(eye) for edge in (corners.min(axis=(0, 1)), corners.max(axis=(0, 1))))
        for u, v in ((1, 2), (0, 1), (0, 2)):
            for at_u in {low[u], high[u]} - {low[0]}:
                for at_v in (low[v], high[v]):
                    on_edge = (slope[:, u] * at_v == slope[:, v] * at_u) & (slope[:, u] * at_u > 0)
                    assert not on_edge.any(), (eye, at_u, at_v)


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
