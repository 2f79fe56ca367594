"""Commands about trials: draft a format, check, measure, report, plan."""
