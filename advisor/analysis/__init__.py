"""Complete logs: several logs as one campaign, marks by hand, and the diagnosis of logs."""
