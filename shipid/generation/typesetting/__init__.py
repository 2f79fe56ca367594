"""The equations of a model in print: LaTeX, MathML for pages, and plain text for a terminal."""
