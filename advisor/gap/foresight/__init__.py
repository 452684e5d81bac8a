"""What a plan of manoeuvres could show, and what a flight could not."""
