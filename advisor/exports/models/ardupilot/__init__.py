"""ArduPilot's built-in plane: a file of coefficients, and parameters of its servos."""
