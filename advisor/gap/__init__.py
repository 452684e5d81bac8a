"""The sim-to-real gap: its block of the simulator, the effect that causes it, and its reduction by a
correction.
"""
