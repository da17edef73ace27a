"""Does a capture, with its logs, agree with what run.yaml says of it: one finding a file, and the list."""
