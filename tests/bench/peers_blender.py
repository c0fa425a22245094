# The same sheet as ten shape keys in Blender: blender -b -P peers_blender.py -- LIBOURS FOLDER
# A whole update of the evaluated mesh, without drawing: what a driven character costs there.
import sys
import time

import bpy

sys.path.insert(0, sys.argv[sys.argv.index("--") + 2])
import peers  # noqa: E402


def make_object(xyz, pull, response):
    mesh = bpy.data.meshes.new("sheet")
    mesh.from_pydata(xyz.tolist(), [], [])
    thing = bpy.data.objects.new("sheet", mesh)
    bpy.context.scene.collection.objects.link(thing)
    thing.shape_key_add(name="rest")
    for k in range(10):
        key = thing.shape_key_add(name=f"control{k}")
        moved = xyz + response[:, k:k + 1] * pull[k]
        key.data.foreach_set("co", moved.astype("f4").ravel())
    return thing


def main():
    import numpy
    ours = peers.Ours(sys.argv[sys.argv.index("--") + 1])
    xyz, _, pull, response = peers.rows(ours, numpy)
    thing = make_object(xyz, pull, response)
    keys = thing.data.shape_keys.key_blocks
    turn = [0]

    def frame():
        turn[0] += 1
        for k in range(1, 11):
            keys[k].value = 0.2 + 0.01 * ((turn[0] * 7 + k) % 60)
        graph = bpy.context.evaluated_depsgraph_get()
        graph.update()
        _ = thing.evaluated_get(graph).data.vertices[0].co.x

    started = time.perf_counter()
    frame()
    print(f"Blender {bpy.app.version_string}, first update {time.perf_counter() - started:.2f} s")
    peers.compare(ours, "Blender, update of a mesh with ten shape keys",
                  lambda: peers.least_ns(frame, 200), ("anchored", "unanchored"))


main()
