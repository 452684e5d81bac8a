"""Results as text, JSON documents, pages and pictures."""
