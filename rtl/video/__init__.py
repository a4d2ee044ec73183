# SPDX-License-Identifier: MIT
"""The monitor's timing, and the double line buffer."""
