"""Uncertainty of the estimates: covariance, residuals, directions, profiles, posterior, draws."""
