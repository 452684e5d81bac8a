"""The Textual application. Imports everything; nothing imports it."""
