"""Independent tasks: done in this process, in processes, or on a cluster, with equal results."""
