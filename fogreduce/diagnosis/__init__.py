"""The gap between simulator and bench: where it lies, which effect causes it, how far that closes it."""
