"""Estimation of roll and yaw: records, start, motion, instruments and estimate."""
