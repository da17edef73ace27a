"""Which run to make next, and what a planned campaign would detect."""
