"""A flight-test campaign: its manoeuvres, estimates and decisions, and what a crew adds by hand."""
