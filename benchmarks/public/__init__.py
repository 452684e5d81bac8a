"""Our rows in an open benchmark of fixed-wing identification: its data format, its metric, our models."""
