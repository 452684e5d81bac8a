"""Estimation problems of the axes other than pitch."""
