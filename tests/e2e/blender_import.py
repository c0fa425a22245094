# blender -b -P blender_import.py -- FILE.glb BARE.glb FILE.pc2 FPS: imports FILE as a person would, and says how far
# what it shows is off the vertices of the point cache at ten times, mm. BARE is the mesh alone: it says where the
# vertices of the cache are at rest, and so which are which.
import json
import struct
import sys

import bpy
import numpy

if not hasattr(numpy, "bool"):  # Debian 12's Blender asks its NumPy for names that it no longer has
    numpy.bool = bool

glb, bare, pc2, fps = sys.argv[sys.argv.index("--") + 1:]

with open(bare, "rb") as file:
    data = file.read()
length = struct.unpack_from("<I", data, 12)[0]
gltf = json.loads(data[20:20 + length])
binary = 20 + length + 8
position = gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
view = gltf["bufferViews"][position["bufferView"]]
start = binary + view.get("byteOffset", 0) + position.get("byteOffset", 0)
rest = [struct.unpack_from("<3f", data, start + 12 * i) for i in range(position["count"])]

with open(pc2, "rb") as file:
    head = struct.unpack("<12siiffi", file.read(32))
    vertices, frames = head[2], head[5]
    if vertices != len(rest):
        sys.exit(f"the cache has {vertices} vertices, the file {len(rest)}")
    cache = file.read()

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = round(float(fps))
bpy.context.scene.render.fps_base = round(float(fps)) / float(fps)
bpy.ops.import_scene.gltf(filepath=glb)
meshes = [o for o in bpy.context.scene.objects if o.type == "MESH" and o.data.shape_keys]
if not meshes:
    sys.exit("nothing with shape keys was imported")


def shown():
    """Of each mesh where its vertices are, mm, in the file's axes; skins and all."""
    graph = bpy.context.evaluated_depsgraph_get()
    for thing in meshes:
        matrix = thing.matrix_world
        mesh = thing.evaluated_get(graph).to_mesh()
        places = [matrix @ v.co for v in mesh.vertices]
        yield thing, [(1000 * x, 1000 * z, -1000 * y) for x, y, z in places]


# At rest: no action plays, no key is on.
playing = {}
for thing in meshes:
    keys = thing.data.shape_keys
    playing[thing] = keys.animation_data.action if keys.animation_data else None
    if playing[thing]:
        keys.animation_data.action = None
    for key in keys.key_blocks:
        key.value = 0
size = max(abs(c) for r in rest for c in r)
cell = 1e-5 * size
places = {}
for i, r in enumerate(rest):
    places.setdefault(tuple(round(c / cell) for c in r), []).append(i)
near = [(a, b, c) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1)]
pairs = []  # an imported vertex and those of the cache that are at its place
at_rest = list(shown())
for turn in (1, -1):  # a file that faces -z, as VRM 0, has half a turn about y
    for thing, at in at_rest:
        for index, (x, y, z) in enumerate(at):
            middle = [round(0.001 * c / cell) for c in (turn * x, y, turn * z)]
            found = [i for n in near for i in places.get(tuple(m + d for m, d in zip(middle, n)), [])]
            if found:
                pairs.append((thing, index, found))
    if pairs:
        break
for thing, action in playing.items():
    if action:
        thing.data.shape_keys.animation_data.action = action

print(f"imported: {len(meshes)} meshes, {sum(len(o.data.vertices) for o in meshes)} vertices, "
      f"{len(pairs)} of them found, {sum(len(o.data.shape_keys.key_blocks) for o in meshes) - 1} targets, "
      f"{sum(1 for i in bpy.data.images if i.size[0] > 0)} images")

print("keys: " + ", ".join(sorted({k.name for o in meshes for k in o.data.shape_keys.key_blocks})))

worst = furthest = 0.0
for n in range(10):
    frame = (frames - 1) * n // 9
    bpy.context.scene.frame_set(frame)
    now = dict(shown())
    for thing, index, found in pairs:
        x, y, z = now[thing][index]
        here = (turn * x, y, turn * z)
        off = 1e9
        for i in found:
            there = struct.unpack_from("<3f", cache, (frame * vertices + i) * 12)
            off = min(off, sum((a - b) ** 2 for a, b in zip(here, there)) ** 0.5)
            moved = sum((1000 * a - b) ** 2 for a, b in zip(rest[i], there)) ** 0.5
            furthest = max(furthest, moved)
        worst = max(worst, off)
print(f"off by {worst:.4f} mm at most; the face moves by up to {furthest:.2f} mm")
