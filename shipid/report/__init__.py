"""Self-contained HTML reports: a report imports the results it shows, and no result imports a report."""
