# SPDX-License-Identifier: MIT
"""blender -b -P gltf_to_fbx.py -- FILE.glb FILE.fbx [FPS]: converts a performance of marotte to FBX, with its morph
targets and their animation. FPS: frames per second of the FBX (default: the rate of the performance).

Unreal keeps shape keys only if the mesh has a skin. A mesh without one gets a rig with one bone, "root", that does not
move. Blender's exporter loses the shape keys of a mesh with any other modifier, and simplifies curves by default.
"""

import json
import struct
import sys

import bpy
import numpy

if "bool" not in vars(numpy):  # Debian 12's importer uses a name that its NumPy no longer has
    numpy.bool = bool


def rate_of(path):
    """Returns the frames per second of the performance."""
    with open(path, "rb") as file:
        head = file.read(20)
        if len(head) < 20 or head[:4] != b"glTF":
            sys.exit(f"{path}: not a .glb file")
        gltf = json.loads(file.read(struct.unpack_from("<I", head, 12)[0]))
    rates = [a["extras"]["fps"] for a in gltf.get("animations", []) if "fps" in a.get("extras", {})]
    return float(rates[0]) if rates else 30.0


def give_skin(thing):
    """Adds a rig with one bone that does not move, if the mesh has no rig."""
    if any(m.type == "ARMATURE" for m in thing.modifiers):
        return
    rig = bpy.data.objects.new(f"{thing.name} rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = rig.data.edit_bones.new("root")
    bone.head, bone.tail = (0, 0, 0), (0, 0, 0.1)
    bpy.ops.object.mode_set(mode="OBJECT")
    above, at = thing.parent, thing.matrix_world.copy()
    rig.parent = above
    rig.matrix_world = at
    thing.parent = rig
    thing.matrix_world = at
    group = thing.vertex_groups.new(name="root")
    group.add(range(len(thing.data.vertices)), 1.0, "REPLACE")
    thing.modifiers.new("rig", "ARMATURE").object = rig


def main():
    arguments = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    if len(arguments) not in (2, 3):
        sys.exit(__doc__)
    source, target = arguments[:2]
    rate = float(arguments[2]) if len(arguments) == 3 else rate_of(source)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = max(1, round(rate))
    scene.render.fps_base = scene.render.fps / rate
    bpy.ops.import_scene.gltf(filepath=source)
    faces = [o for o in scene.objects if o.type == "MESH" and o.data.shape_keys]
    if not faces:
        sys.exit(f"{source}: has no morph targets, so the face does not move")
    actions = []
    for thing in faces:
        for modifier in [m for m in thing.modifiers if m.type != "ARMATURE"]:
            thing.modifiers.remove(modifier)
        give_skin(thing)
        data = thing.data.shape_keys.animation_data
        if data and data.action:
            actions.append(data.action)
            for track in data.nla_tracks:
                track.mute = True  # the importer also puts the same action into a track
    scene.frame_start = 0
    scene.frame_end = max((int(round(a.frame_range[1])) for a in actions), default=0)
    bpy.ops.export_scene.fbx(
        filepath=target, object_types={"MESH", "ARMATURE", "EMPTY"}, use_mesh_modifiers=False, add_leaf_bones=False,
        bake_anim=True, bake_anim_use_all_actions=False, bake_anim_use_nla_strips=False, bake_anim_simplify_factor=0.0,
        bake_anim_step=1.0, mesh_smooth_type="OFF", path_mode="COPY", embed_textures=True)
    shapes = {k.name for o in faces for k in o.data.shape_keys.key_blocks[1:]}
    print(f"wrote {target}: {len(faces)} meshes, {len(shapes)} morph targets, frames 0 to {scene.frame_end} at {rate:g} "
          "a second")


main()
