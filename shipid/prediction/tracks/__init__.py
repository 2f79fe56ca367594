"""Predicted tracks: the model along the distance sailed, orders, bands."""
