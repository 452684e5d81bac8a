"""The stream of one vehicle: columns of messages in, events of the flight test out."""
