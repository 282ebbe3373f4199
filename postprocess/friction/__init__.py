"""Results of tractions on the contact: forces, slip, wear and shakedown."""
