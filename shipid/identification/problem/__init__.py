"""The problem of an identification: model, trials, unknowns, residuals, prior, losses."""
