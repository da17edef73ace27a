"""What commands do, as functions for Python, with results that show themselves and have a `plot`."""
