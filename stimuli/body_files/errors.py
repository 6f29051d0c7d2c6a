"""What is said to people when a body can't be used."""


class BodyError(ValueError):
    """One sentence that names the body or file, what is wrong with it, and where possible the way out."""
