"""Where a residual departs from nothing, causes aside."""
