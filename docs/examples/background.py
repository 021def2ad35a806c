"""Trace the demo scene without a window and save it: needs Heliform installed and enabled.

blender --background --python-exit-code 1 --python background.py -- result.blend
"""

import sys
from pathlib import Path

import bpy

target = Path(sys.argv[sys.argv.index("--") + 1] if "--" in sys.argv else "caustic.blend")

bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
bpy.ops.heliform.add_demo()
tracing = bpy.context.scene.heliform.photon_tracing
tracing.until, tracing.landed = "landed", 500_000
bpy.ops.heliform.trace_photons()

picture = bpy.context.scene.heliform.shown
print(f"{picture.name}: {picture.size[0]} × {picture.size[1]} texels")
bpy.ops.wm.save_as_mainfile(filepath=str(target.resolve()))
