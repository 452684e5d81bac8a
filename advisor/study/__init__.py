"""The paper's simulated campaign, flown many times, and what the advisor adds to it measured the same way."""
