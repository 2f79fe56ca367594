"""What the page shows, as JSON can hold it."""
