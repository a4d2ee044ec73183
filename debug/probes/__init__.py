# SPDX-License-Identifier: MIT
"""Map each engine's signals in a waveform to the golden model's values of a ray."""
