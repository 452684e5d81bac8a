"""Whole logs: several as one campaign, marks by hand, and the diagnosis of logs."""
