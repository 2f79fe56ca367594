"""The same filter for samples that arrive one by one, and its state in a file."""
