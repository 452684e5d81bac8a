"""Parts of the gap diagnosis for roll and yaw: effects, fits, gusts and evidence."""
