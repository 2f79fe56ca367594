"""Commands that find a model out of trials: compare, identify, filter."""
