"""Planners over scenes and seeds: trials, studies, tables and the command line."""
