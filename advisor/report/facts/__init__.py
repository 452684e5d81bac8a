"""The one owner of each number and sentence of a flight that several faces state: faces paint facts."""
