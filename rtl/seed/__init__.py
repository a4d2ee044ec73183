# SPDX-License-Identifier: MIT
"""The seed engine: it divides once per rectangle, and rounds."""
