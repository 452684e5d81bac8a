"""Parts of an effect: its description, its variants in a fit, and shapes that several effects share."""
