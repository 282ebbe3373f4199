"""What error estimates rest on and whether they hold; what effects change."""
