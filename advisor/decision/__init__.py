"""Was that manoeuvre good, may we stop, what to fly next."""
