# SPDX-License-Identifier: MIT
"""The seed engine: divides once a rectangle and rounds."""
