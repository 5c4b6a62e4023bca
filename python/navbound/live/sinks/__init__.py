"""Where the transitions of a session go: a list of lines, tables, a webhook. All read what stands in the journal out."""
