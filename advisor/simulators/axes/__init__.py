"""One axis of the user's simulator."""
