"""Tasks that do not know of one another: done here, in processes, or on a cluster, with equal results."""
