"""Two finished runs compared: their records, their settings, and their epochs one by one."""
