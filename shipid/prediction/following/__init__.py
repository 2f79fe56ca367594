"""A manoeuvre as it is sailed: when it has to begin, and how its predicted track follows the ship."""
