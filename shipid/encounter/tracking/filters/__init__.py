"""The filters of targets: modes and their generated prediction, multiple-model filters, and the fuzzy alpha-beta bank."""
