"""Logs of any kind: recognised, unpacked, opened."""
