"""The catalogue's effects as columns: what each would change in block means."""
