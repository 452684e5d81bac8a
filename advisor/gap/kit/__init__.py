"""What an effect is made of: its description, its forms in a fit, and shapes that several effects share."""
