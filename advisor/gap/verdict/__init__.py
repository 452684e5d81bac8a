"""From the evidence to the verdict, its causes, its numbers and its sentence."""
