"""The evidence of a diagnosis: one row for each alternative, with the same columns in every row."""
