"""From trials to an identified ship, with its uncertainty."""
