"""Many flights: every log analyzed once, in processes, resumable; with tables and changes."""
