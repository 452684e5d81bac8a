"""Manoeuvres: their finding in the elevator's samples, their marks, and the events that tell of them."""
