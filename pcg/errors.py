"""The one exception for bad input, shared by every package."""


class InputError(ValueError):
    """A file, a field or an argument that cannot be used.

    The message is one line for the user: where (file and field or line), what was found, what is allowed. The
    command line prints it as it is and exits with status 2.
    """

    def __init__(self, where: str, problem: str) -> None:
        super().__init__(f"{where}: {problem}" if where else problem)
