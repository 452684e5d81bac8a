"""Many flights: every log analyzed once, in processes, resumable; tables and changes over all of them."""
