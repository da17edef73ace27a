"""Figures of a reduced run, one file a figure; and the pictures of the docs."""

#: File formats in which figures are written.
FORMATS = ("png", "svg")
