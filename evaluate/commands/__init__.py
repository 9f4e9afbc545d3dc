"""The commands of the command line, one module a command.

Each has its Typer application `app`, whose function declares the arguments, documents itself by its help, and returns
whether all went well: False stands for a clean negative.
"""
