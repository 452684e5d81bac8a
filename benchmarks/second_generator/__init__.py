"""A second generator of flights, written from the contract alone, to check the diagnosis with."""
