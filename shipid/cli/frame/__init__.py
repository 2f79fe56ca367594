"""What every command stands on: its options, how it is called and stopped, what it says, how it hands over its result."""
