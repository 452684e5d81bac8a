"""Test inputs of one axis, as recognised in flight."""
