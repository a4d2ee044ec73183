# SPDX-License-Identifier: MIT
"""From VGA to the symbols of a DVI link."""
