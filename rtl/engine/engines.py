# SPDX-License-Identifier: MIT
"""The engines, which are exchangeable: blocks with the ports of ray_caster, and renderers with those of its own."""

from raycaster.rtl.exact.exact_caster import exact_caster
from raycaster.rtl.seed.ray_caster import ray_caster

ENGINES = {"seed": ray_caster, "exact": exact_caster}
"""Those that fill a line buffer, by the configuration's name for them."""
