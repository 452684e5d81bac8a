"""Analysis of many flights. Processes analyze every log once, a run can be resumed, and the results are
tables and changes.
"""
