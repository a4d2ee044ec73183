# SPDX-License-Identifier: MIT
"""The registers behind Avalon-MM, bridges from other buses, and the processor's bus."""
