"""Parts that need the bundled simulator: the demonstration and the study."""
