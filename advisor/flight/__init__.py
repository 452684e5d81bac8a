"""Flight data: channels with units on the vehicle's clock, and the manoeuvres found in them."""
