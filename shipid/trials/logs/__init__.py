"""From a log file to a trial, and back: text, Parquet, NMEA 0183, trial formats."""
