"""The noise behind the residuals: its colour, over holes and between signals, and what filled inputs add."""
