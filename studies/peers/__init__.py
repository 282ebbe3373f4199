"""Other contact codes on hertz_ellipse, measured in the same run as this one."""
