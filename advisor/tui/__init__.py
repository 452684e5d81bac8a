"""The Textual application. The package imports all others, and none imports it."""
