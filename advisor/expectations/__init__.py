"""Comparison of a flight with expectations: the expectations of a crew, the results of a log, and the
outcomes.
"""
