"""Frames on the wire: layouts, checksums, signatures, and the compiled scan."""
