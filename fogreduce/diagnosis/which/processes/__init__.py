"""Random processes in block means."""
