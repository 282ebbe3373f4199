"""Laws of friction that slip and temperature change, and heat of surfaces that roll and slip."""
