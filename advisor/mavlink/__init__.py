"""Bytes and messages: logs, live link, and who the vehicle is."""
