"""What tractions on the contact do: forces, slip, wear and shakedown."""
