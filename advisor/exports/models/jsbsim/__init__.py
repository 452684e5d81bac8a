"""A corrected copy of the user's JSBSim aircraft."""
