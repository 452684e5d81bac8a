"""Monte-Carlo studies of the stop, of the advice and of a changed aircraft."""
