"""The work of each command of the command line, one module a command."""
