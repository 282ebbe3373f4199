"""The battery of hard cases: one list, run by the study `hard_cases` and, in part, by the tests."""
