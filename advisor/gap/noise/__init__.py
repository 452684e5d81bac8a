"""What is there besides the simulator: noise with a memory, air that moves, stamps that jitter."""
