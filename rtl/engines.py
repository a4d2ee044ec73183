# SPDX-License-Identifier: MIT
"""The engines."""

from collections.abc import Mapping

from raycaster.configuration import Configuration
from raycaster.rtl.buffered.engine import LineBufferedEngine
from raycaster.rtl.engine.engine import Engine
from raycaster.rtl.exact.engine import EXACT
from raycaster.rtl.seed.engine import SEED
from raycaster.rtl.span.engine import SPAN

ENGINES: Mapping[str, Engine] = {one.facts.name: one for one in (SEED, EXACT, SPAN)}
"""Engines by name; the first one is the default."""

SUCCESSORS: Mapping[object, str] = {"beam": "span"}
"""Engines that replace engines of earlier versions, by their names."""


def engine_of(config: Configuration) -> Engine:
    """Return the engine of a design."""
    return ENGINES[config.engine]


def buffered_engine_of(config: Configuration) -> LineBufferedEngine:
    """Return the engine of a design with a line buffer."""
    engine = engine_of(config)
    assert isinstance(engine, LineBufferedEngine)
    return engine
