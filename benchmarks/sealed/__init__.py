"""What the generators of sealed flights share beside ``sim.sealed``: no physics."""
