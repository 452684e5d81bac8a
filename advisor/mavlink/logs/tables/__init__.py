"""Tables with named columns (CSV, MAT) as logs: the file, the names, the messages."""
