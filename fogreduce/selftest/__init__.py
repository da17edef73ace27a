"""Published numbers, computed by the installed software: expected beside obtained."""
