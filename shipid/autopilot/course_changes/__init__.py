"""Course changes, simulated and measured: batches of runs, the weather they meet, what is measured."""
