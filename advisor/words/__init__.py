"""Words for people: errors, numbers, times, remedies."""
