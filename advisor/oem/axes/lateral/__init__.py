"""Roll and yaw: records, start, motion, instruments and estimate."""
