"""What a user says of a filter, read and checked: sensors, noise, first estimates."""
