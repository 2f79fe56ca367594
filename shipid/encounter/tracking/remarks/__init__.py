"""What is said beside the tracks: what they contradict, and which of them are no target."""
