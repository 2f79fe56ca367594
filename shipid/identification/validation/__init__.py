"""Predictions of trials: fitted, left out, in closed loop; bands; comparison of models."""
