"""Files and folders as bytes: packed files within a limit, folders that are whole or are not read. Nothing here knows a format."""
