"""How sure the estimates are: covariance, residuals, directions, profiles, posterior, draws."""
