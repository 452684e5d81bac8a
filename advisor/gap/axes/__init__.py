"""The engine's axes other than pitch."""
