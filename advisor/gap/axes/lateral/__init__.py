"""Roll and yaw as the engine asks for them: effects, fits, gusts and evidence."""
