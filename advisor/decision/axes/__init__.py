"""Requirements of each axis on a manoeuvre, as data and formulas of the axis' motion."""
