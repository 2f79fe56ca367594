"""What a measured manoeuvre amounts to: quantities with units, reasons where one is not known, and notes."""
