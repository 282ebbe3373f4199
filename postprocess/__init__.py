"""From a solution to findings, tables, files and pictures; never solves."""
