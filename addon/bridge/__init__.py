"""Blender's data as plain arrays, and results as Blender's data. Nothing is computed here."""
