"""The demo scene traced by the installed extension: ``blender --background --python`` runs this."""

import sys

import bpy

scene = bpy.context.scene
assert bpy.ops.heliform.add_demo() == {"FINISHED"}
scene.heliform.photon_tracing.until = "landed"
scene.heliform.photon_tracing.landed = 20_000
assert bpy.ops.heliform.trace_photons() == {"FINISHED"}

picture = scene.heliform.shown
assert picture.packed_file
assert picture.size[0] == picture.size[1] > 0
bpy.ops.wm.save_as_mainfile(filepath=sys.argv[sys.argv.index("--") + 1])
print("picture:", picture.name)
