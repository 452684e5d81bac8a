"""Independent tasks, done in this process, in other processes, or on a cluster, with equal results."""
