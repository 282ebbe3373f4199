"""The input: scenes of a wheel on a rail, their keys, units, steels and files."""
