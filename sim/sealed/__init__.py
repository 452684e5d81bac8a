"""Protocol of sealed flights for every generator: write, seal, commit, reveal, score."""
