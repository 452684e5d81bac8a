"""The tables by which the proof of an improved simulator reads each axis."""
