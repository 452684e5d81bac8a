"""Foresight: effects that a plan of manoeuvres could show, and effects that a flight could not show."""
