"""The process of the program: start, signals, compiled functions, files, tasks."""
