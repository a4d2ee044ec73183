# SPDX-License-Identifier: MIT
"""An encoder from VGA to the symbols of a DVI link."""
