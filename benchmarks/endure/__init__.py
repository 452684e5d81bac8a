"""Endurance: flights in every unkind form, each answered by the advisor."""
