# blender -b -P blender_fbx.py -- FILE.fbx BARE.glb FILE.pc2 FPS: imports FILE, and says how far what it shows is off the
# point cache at ten times, mm; that each of its meshes has a skin, without which Unreal drops what moves it.
import os
import sys

import bpy

sys.dont_write_bytecode = True
sys.path.append(os.path.dirname(os.path.abspath(__file__)))
from blender_cache import Cache, meshes_with_shapes, still

fbx, bare, pc2, fps = sys.argv[sys.argv.index("--") + 1:]
cache = Cache(bare, pc2)
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = int(fps)
bpy.ops.import_scene.fbx(filepath=fbx)
meshes = meshes_with_shapes()
if not meshes:
    sys.exit("nothing with shape keys was imported")
for thing in meshes:
    if not thing.find_armature() or not all(v.groups for v in thing.data.vertices):
        sys.exit(f"{thing.name} has no skin")
playing = {o: o.data.shape_keys.animation_data.action for o in meshes}
still(meshes)
found = cache.find(meshes)
for thing, action in playing.items():
    thing.data.shape_keys.animation_data.action = action
print(f"imported: {len(meshes)} meshes, {found} vertices found, "
      f"{max(len(o.data.shape_keys.key_blocks) for o in meshes) - 1} targets")
# The importer begins at frame 1.
print("off by %.4f mm at most; the face moves by up to %.2f mm" % cache.off(lambda frame: 1 + frame))
