# blender -b -P blender_import.py -- FILE.glb FILE.pc2 FPS: imports the file as a person would, and says how far
# the mesh is off the vertices of the point cache at ten times, mm. PC2 has every frame, in the order of the
# file's vertices.
import json
import struct
import sys

import bpy
import numpy

if not hasattr(numpy, "bool"):  # Debian 12's Blender asks its NumPy for names that it no longer has
    numpy.bool = bool

glb, pc2, fps = sys.argv[sys.argv.index("--") + 1:]

with open(glb, "rb") as file:
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

places = {}
for i, (x, y, z) in enumerate(rest):
    places.setdefault((round(x, 6), round(-z, 6), round(y, 6)), []).append(i)
pairs = []  # an imported vertex and those of the file that are at its place
for thing in meshes:
    for v in thing.data.vertices:
        at = thing.matrix_world @ v.co
        found = places.get(tuple(round(c, 6) for c in at))
        if found:
            pairs.append((thing, v.index, found))
print(f"imported: {len(meshes)} meshes, {sum(len(o.data.vertices) for o in meshes)} vertices, "
      f"{len(pairs)} of them found, {sum(len(o.data.shape_keys.key_blocks) for o in meshes) - 1} targets, "
      f"{sum(1 for i in bpy.data.images if i.size[0] > 0)} images")

worst = furthest = 0.0
for n in range(10):
    frame = (frames - 1) * n // 9
    bpy.context.scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    shown = {o: (o.evaluated_get(graph).to_mesh(), o.matrix_world.copy()) for o in meshes}
    for thing, index, found in pairs:
        mesh, matrix = shown[thing]
        x, y, z = matrix @ mesh.vertices[index].co
        here = (1000 * x, 1000 * z, -1000 * y)
        off = 1e9
        for i in found:
            there = struct.unpack_from("<3f", cache, (frame * vertices + i) * 12)
            off = min(off, sum((a - b) ** 2 for a, b in zip(here, there)) ** 0.5)
            moved = sum((1000 * a - b) ** 2 for a, b in zip(rest[i], there)) ** 0.5
            furthest = max(furthest, moved)
        worst = max(worst, off)
print(f"off by {worst:.4f} mm at most; the face moves by up to {furthest:.2f} mm")
