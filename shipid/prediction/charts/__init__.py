"""Charts: land, depths, coastlines and buoys out of S-57 or GeoJSON, in local metres."""
