"""What is found without solving: places of contact, measured profiles, paths of a wheel, steels."""
