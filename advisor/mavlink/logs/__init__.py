"""Logs of any kind: recognition, unpacking and opening."""
