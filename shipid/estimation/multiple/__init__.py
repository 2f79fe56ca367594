"""Multiple-model filters: several declared models at once, and which of them holds."""
