# SPDX-License-Identifier: MIT
"""Debug a wrong pixel: record waveforms, and compare one pixel's life with the golden model."""
