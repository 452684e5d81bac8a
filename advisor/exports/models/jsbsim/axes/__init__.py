"""Parts of a JSBSim aircraft that belong to one axis."""
