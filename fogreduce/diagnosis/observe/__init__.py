"""Captures to residuals of block means and full-rate statistics, beside a prediction by the simulator."""
