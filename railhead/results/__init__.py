"""What a run leaves: summary, checks, tables and the result folder."""
