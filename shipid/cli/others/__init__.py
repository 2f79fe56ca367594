"""Commands for other ships and many runs: track, campaign."""
