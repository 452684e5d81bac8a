"""Words for people: errors, numbers, times, fixes."""
