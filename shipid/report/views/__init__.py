"""Results as a page shows them, one file a result."""
