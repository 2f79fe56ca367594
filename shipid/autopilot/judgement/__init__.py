"""The judgement of a design: margins, course changes, robustness, weather."""
