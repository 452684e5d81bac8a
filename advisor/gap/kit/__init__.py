"""Parts of an effect: its description, its forms in a fit, and shapes that several effects share."""
