"""Methods that search the coefficients, and the ladder that tries them in order."""
