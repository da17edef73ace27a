"""A stage as a node of the workflow: it reads the files of the stages before it and writes its own."""
