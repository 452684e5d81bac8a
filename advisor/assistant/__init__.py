"""Read-only tools for an assistant that speaks the Model Context Protocol."""
