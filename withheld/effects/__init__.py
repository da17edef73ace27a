"""What can be wrong: the catalogue's effects, and some that never were in it."""
