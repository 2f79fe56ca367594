"""From trials to an identified ship, with honest uncertainty."""
