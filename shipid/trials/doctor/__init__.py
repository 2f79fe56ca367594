"""The trial doctor: what is wrong with a record, what it does to an identification, and what repairs it."""
