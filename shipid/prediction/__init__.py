"""The track predictor: where a ship goes under an order, how sure that is, and how the prediction follows the ship."""
