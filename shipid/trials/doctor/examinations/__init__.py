"""The examinations of the trial doctor, one file a subject."""
