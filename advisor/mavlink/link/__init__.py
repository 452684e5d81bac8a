"""The live link: connection, supervision, recording and requests."""
