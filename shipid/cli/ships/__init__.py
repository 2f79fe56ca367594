"""Commands about models and ships: list, show, simulate, judge."""
