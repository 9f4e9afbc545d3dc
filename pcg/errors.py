"""The one exception for bad input, shared by every package."""

from pcg.printable import one_line


class InputError(ValueError):
    """A file, a field or an argument that cannot be used.

    The message is one line for the user: where (file and field or line), what was found, what is allowed. Whatever a
    file holds, it is printable and of bounded length. The command line prints it as it is and exits with status 2.
    """

    def __init__(self, where: str, problem: str) -> None:
        super().__init__(one_line(f"{where}: {problem}" if where else problem))
