"""File formats of scenes."""
