# SPDX-License-Identifier: MIT
"""Select the description of a design's engine."""

from raycaster.configuration import Configuration
from raycaster.debug.probes.exact import ExactProbes
from raycaster.debug.probes.ray import Description
from raycaster.debug.probes.seed import SeedProbes
from raycaster.debug.probes.span import SpanProbes
from raycaster.errors import UserError
from raycaster.rtl.engines import EXACT, SEED, SPAN, engine_of

DESCRIPTIONS = {SEED: SeedProbes, EXACT: ExactProbes, SPAN: SpanProbes}
"""Descriptions by engine."""


def description_of(config: Configuration, unit: int) -> Description:
    """Return the engine's description for the pixels of a ray unit.

    Raises:
        UserError: the engine has none, or a built-in scene is described only for other engines.
    """
    if config.fixed and not config.facts.whole_frames:
        raise UserError(f"fix: the signals of {config.engine} are described only without it; leave it out for a trace")
    if engine_of(config) not in DESCRIPTIONS:
        raise UserError(f"engine: the signals of {config.engine} are not described; choose another for a trace")
    return DESCRIPTIONS[engine_of(config)](config, unit)
