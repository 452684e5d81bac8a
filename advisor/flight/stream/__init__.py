"""Stream of one vehicle: columns of messages as input, events of the flight test as output."""
