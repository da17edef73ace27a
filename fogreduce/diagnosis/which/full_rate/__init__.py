"""What the full rate says: spectra and lines, the link, stamps and the converter."""
