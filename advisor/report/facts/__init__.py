"""Facts: each number and sentence that several screens and pages state, made in one place."""
