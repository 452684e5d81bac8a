"""Corrected copy of the user's JSBSim aircraft."""
