"""The manoeuvres of one axis, from a stream of messages."""
