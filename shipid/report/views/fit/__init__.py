"""An identified model as a page: sections, one file a subject."""
