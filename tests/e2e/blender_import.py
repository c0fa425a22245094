# blender -b -P blender_import.py -- FILE.glb BARE.glb FILE.pc2 FPS: imports FILE as a person would, and says how far
# what it shows is off the vertices of the point cache at ten times, mm. BARE is the mesh alone.
import os
import sys

import bpy

sys.dont_write_bytecode = True
sys.path.append(os.path.dirname(os.path.abspath(__file__)))
from blender_cache import Cache, meshes_with_shapes, still

glb, bare, pc2, fps = sys.argv[sys.argv.index("--") + 1:]
cache = Cache(bare, pc2)

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = round(float(fps))
bpy.context.scene.render.fps_base = round(float(fps)) / float(fps)
bpy.ops.import_scene.gltf(filepath=glb)
meshes = meshes_with_shapes()
if not meshes:
    sys.exit("nothing with shape keys was imported")

playing = {o: o.data.shape_keys.animation_data and o.data.shape_keys.animation_data.action for o in meshes}
still(meshes)
found = cache.find(meshes)
for thing, action in playing.items():
    if action:
        thing.data.shape_keys.animation_data.action = action

print(f"imported: {len(meshes)} meshes, {sum(len(o.data.vertices) for o in meshes)} vertices, "
      f"{found} of them found, {sum(len(o.data.shape_keys.key_blocks) for o in meshes) - 1} targets, "
      f"{sum(1 for i in bpy.data.images if i.size[0] > 0)} images")
print("keys: " + ", ".join(sorted({k.name for o in meshes for k in o.data.shape_keys.key_blocks})))
print("off by %.4f mm at most; the face moves by up to %.2f mm" % cache.off(lambda frame: frame))
