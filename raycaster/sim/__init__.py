# SPDX-License-Identifier: MIT
"""Models of a design in a simulator: building and running them, and what every bench needs."""
