# SPDX-License-Identifier: MIT
"""The engines: their features, timing and size."""

from collections.abc import Mapping

from raycaster.engines.beam import Beam
from raycaster.engines.engine import Engine
from raycaster.engines.exact import Exact
from raycaster.engines.seed import Seed

SEED, EXACT, BEAM = Seed(), Exact(), Beam()
ENGINES: Mapping[str, Engine] = {engine.name: engine for engine in (SEED, EXACT, BEAM)}
"""Engines by name."""
