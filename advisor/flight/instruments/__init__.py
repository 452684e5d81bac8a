"""Instruments as models: what the motion alone tells about them."""
