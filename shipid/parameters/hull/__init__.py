"""Linear derivatives of a hull from its particulars, by a published regression."""
