"""The flight-test campaigns of the pitch axis and of the lateral axes."""
