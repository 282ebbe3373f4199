"""Every effect on and off: what it costs, what leaving it out changes, and that off is free."""
