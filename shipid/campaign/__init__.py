"""Many runs of one study, or one study of many trials: on this machine or a cluster, interrupted and resumed."""
