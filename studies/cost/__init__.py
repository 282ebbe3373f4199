"""What a solve costs: time and memory by size, by processes, and by effect."""
