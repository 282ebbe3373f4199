"""Many scenes: grids of values, solved one after the other or side by side, records, tables."""
