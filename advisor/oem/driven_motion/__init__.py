"""Estimation of a motion that unknown forces drive."""
