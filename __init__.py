"""Heliform: light-driven form in Blender. Inert until Blender calls `register`."""


def register() -> None:
    """Add Heliform's properties, operators and panels to Blender."""
    from . import addon

    addon.register()


def unregister() -> None:
    """Take everything that `register` added away again."""
    from . import addon

    addon.unregister()
