"""Many flights: every log is analyzed once, in processes, resumable; with tables and changes."""
