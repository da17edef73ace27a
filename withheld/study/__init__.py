"""A study: its protocol, its cases, and how it is sealed."""
