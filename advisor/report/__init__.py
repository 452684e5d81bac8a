"""Results without a screen: text, JSON, pictures."""
