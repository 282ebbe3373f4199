"""What error estimates rest on, whether they hold, and what accuracy costs."""
