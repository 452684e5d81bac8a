"""The advisor's script flown by ArduPlane itself: what was asked, what was flown, and how fast it ends."""
