"""Effects that a simulator may lack, as physical components to fit to an aircraft."""
