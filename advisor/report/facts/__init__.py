"""Numbers and sentences that several screens and pages state. One function makes each."""
