"""Scripts by which an autopilot flies the test inputs alone: one file for each autopilot."""
