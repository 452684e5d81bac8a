"""Bytes and messages: logs, the live link, and the identity of the vehicle."""
