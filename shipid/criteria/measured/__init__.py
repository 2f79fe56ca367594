"""The sheet of a trial day: every manoeuvre of the logs measured, beside the limits of IMO MSC.137(76), without a model."""
