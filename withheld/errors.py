"""The one error that people see."""


class BadInput(Exception):
    """Input or usage that cannot be used; its text is one clear line (name, value, what was expected)."""
