"""Commands and codes in processes of their own, and what they cost."""
