"""Calibration records derived from a campaign: one weighted least-squares solution over all its runs."""
