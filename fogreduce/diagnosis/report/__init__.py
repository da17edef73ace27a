"""A diagnosis on disk: documents, page and figures."""
