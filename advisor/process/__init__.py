"""The advisor's process: start, signals, compiled functions, files, tasks."""
