# SPDX-License-Identifier: MIT
"""A wrong pixel: waveforms, and one pixel's life held against golden."""
