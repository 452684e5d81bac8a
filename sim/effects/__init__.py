"""Effects that a simulator may lack, as physical components of an aircraft."""
