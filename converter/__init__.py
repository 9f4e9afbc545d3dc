"""Continuous scenes of manipulation puzzles: conversion of levels, geometry presets, files, preview and pictures.

A `Scene` is an immutable description in metres; `convert_level` makes one from a grid level, `read_scene` from a file,
`with_preset` changes its geometry. Plans have their file format here too. Rendering (`converter.render_scene` and its
neighbours) and the physics preview are imported by their own names, because they need heavier libraries.
"""

from converter.convert import ConversionSettings, convert_level
from converter.formats import read_scene, write_scene
from converter.occlusion import occluded
from converter.plan import Plan, Segment, Status, Subgoal, read_plan, write_plan
from converter.preset import CLEAR, PRESETS, PUBLISHED, Preset, with_preset, with_tolerance
from converter.scene import Agent, Body, Goal, Scene
from converter.shape import Part

__all__ = [
    "CLEAR",
    "PRESETS",
    "PUBLISHED",
    "Agent",
    "Body",
    "ConversionSettings",
    "Goal",
    "Part",
    "Plan",
    "Preset",
    "Scene",
    "Segment",
    "Status",
    "Subgoal",
    "convert_level",
    "occluded",
    "read_plan",
    "read_scene",
    "with_preset",
    "with_tolerance",
    "write_plan",
    "write_scene",
]
