"""The settings of a filter, read and checked: sensors, noise, first estimates."""
