"""YAML text of scene files; see `pcg.yaml_text`."""

from pcg.yaml_text import MAX_DEPTH, WIDTH, Flow, dump, parse

__all__ = ["MAX_DEPTH", "WIDTH", "Flow", "dump", "parse"]
