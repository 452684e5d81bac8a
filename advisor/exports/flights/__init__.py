"""Flights as files for other tools: tables with names and units, and the writers of each format."""
