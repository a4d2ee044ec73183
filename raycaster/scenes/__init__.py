# SPDX-License-Identifier: MIT
"""Scenes worth looking at; see `raycaster.scene.packaged_scenes`."""
