"""The declaration language: quantities with units, components, joining, the unit check, the vocabulary of fields."""
