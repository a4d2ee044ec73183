# SPDX-License-Identifier: MIT
"""Where each engine has, in a waveform, what golden knows of a ray."""
