"""What error estimates rest on and whether they hold; what accuracy costs, and effects."""
