"""What the proof of an improved simulator knows of each axis."""
