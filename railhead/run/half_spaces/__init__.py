"""Half-spaces in the place of finite bodies, or beside them: normal and tangential contact."""
