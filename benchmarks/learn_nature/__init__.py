"""Natural widths of the diagnosis, learnt from kept evidence and scored on the generator left out."""
