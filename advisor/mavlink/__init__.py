"""Bytes and messages: logs, the live link, and the vehicle's identity."""
