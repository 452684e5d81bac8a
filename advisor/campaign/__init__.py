"""A flight-test campaign: its manoeuvres, estimates and decisions, with the crew's own decisions."""
