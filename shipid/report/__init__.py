"""Self-contained HTML reports: reports know results, results know nothing of reports."""
