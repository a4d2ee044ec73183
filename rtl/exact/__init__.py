# SPDX-License-Identifier: MIT
"""The exact engine: it cross-multiplies, and never divides or rounds."""
