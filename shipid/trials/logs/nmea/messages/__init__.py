"""NMEA 2000 in the forms canboat writes: what stands in a line, what each message carries, and the log they make."""
