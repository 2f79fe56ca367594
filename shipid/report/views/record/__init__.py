"""Pages of what is neither fitted nor judged: a trial, a voyage, a track, a smoothed or multiple-model record."""
