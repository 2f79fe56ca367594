"""What is known of a ship when a prediction begins, and the filter that knows it."""
