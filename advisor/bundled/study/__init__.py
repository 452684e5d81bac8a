"""The paper's simulated campaign, flown many times, and measures of the advisor's additions."""
