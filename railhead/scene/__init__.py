"""What a person may say about a wheel on a rail."""
