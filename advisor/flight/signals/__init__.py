"""Conversion of messages to physical quantities, each at its own stamps on the vehicle's clock."""
