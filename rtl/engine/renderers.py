# SPDX-License-Identifier: MIT
"""The renderers, which are exchangeable: blocks with the ports of ray_caster_renderer."""

from raycaster.rtl.beam.beam_renderer import beam_renderer
from raycaster.rtl.common.legacy import PipelinedRects, SequentialRects
from raycaster.rtl.video.ray_caster_renderer import ray_caster_renderer

RENDERERS = {"seed": ray_caster_renderer, "exact": ray_caster_renderer, "beam": beam_renderer}
RECTS = {"seed": SequentialRects, "exact": SequentialRects, "beam": PipelinedRects}
"""How each reads the rectangles; both by the configuration's name for the engine."""
