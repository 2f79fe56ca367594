"""One step of a filter as generated code: equations, forms of the covariance, gate."""
