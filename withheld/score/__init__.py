"""Diagnoses judged against the sealed labels."""
