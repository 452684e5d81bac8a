"""Manoeuvres: their detection in elevator samples, marks by the crew, and the events about them."""
