"""Families of shapes that no effect of the catalogue makes."""
