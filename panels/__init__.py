"""What is drawn in the sidebar: a parent panel, and one below it for each room."""

CATEGORY = "Heliform"
PARENT = "HELIFORM_PT_heliform"
"""The parent panel; a room's panel has this as its bl_parent_id."""


class Sidebar:
    """Where all of Heliform's panels are."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = CATEGORY


class Room(Sidebar):
    """A room's panel, below the parent."""

    bl_parent_id = PARENT
