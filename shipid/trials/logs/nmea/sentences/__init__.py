"""NMEA 0183: what stands in a line, what each sentence carries, and the log they make."""
