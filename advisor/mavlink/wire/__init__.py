"""Frames in transmission: layouts, checksums, signatures, and the compiled scan."""
