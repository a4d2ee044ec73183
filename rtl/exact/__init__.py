# SPDX-License-Identifier: MIT
"""The exact engine: cross-multiplies, never divides, never rounds."""
