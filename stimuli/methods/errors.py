"""The error of every way of making a walk. Imports nothing."""


class MethodError(ValueError):
    """A method cannot make the walk that is asked for; the message is a sentence for people."""
