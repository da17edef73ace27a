"""The measurement chain of a capture, written from the contract's text alone."""
