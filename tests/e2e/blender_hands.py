# blender -b -P blender_hands.py -- FILE.bvh: Blender's importer puts each joint where the file says, at ten frames. The
# file is read here by the format's description, not with the writer's code.
import sys

import bpy
from mathutils import Matrix, Vector
from math import radians

path = sys.argv[sys.argv.index("--") + 1]
with open(path) as file:
    words = iter(file.read().split())
joints = []  # name, parent, offset, channels


def joint(parent, name):
    index = len(joints)
    assert next(words) == "{" and next(words) == "OFFSET"
    joints.append((name, parent, Vector([float(next(words)) for _ in range(3)]), []))
    for word in words:
        if word == "CHANNELS":
            joints[index][3].extend(next(words) for _ in range(int(next(words))))
        elif word == "}":
            return
        else:
            joint(index, next(words))


assert next(words) == "HIERARCHY" and next(words) == "ROOT"
joint(None, next(words))
assert [next(words) for _ in range(2)] == ["MOTION", "Frames:"]
frames = int(next(words))
assert [next(words) for _ in range(2)] == ["Frame", "Time:"]
rate = 1 / float(next(words))
motion = [float(w) for w in words]
width = sum(len(j[3]) for j in joints)
assert len(motion) == frames * width


def places(frame):
    values = iter(motion[frame * width:(frame + 1) * width])
    at = []
    for name, parent, offset, channels in joints:
        place, turn = offset.copy(), Matrix.Identity(4)
        for channel in channels:
            value = next(values)
            if channel.endswith("position"):
                place["XYZ".index(channel[0])] = value
            else:
                turn = turn @ Matrix.Rotation(radians(value), 4, channel[0])
        matrix = Matrix.Translation(place) @ turn
        at.append(matrix if parent is None else at[parent] @ matrix)
    return {j[0]: m.to_translation() for j, m in zip(joints, at)}


bpy.ops.wm.read_factory_settings(use_empty=True)
from io_anim_bvh import import_bvh

# Debian 12's importer opens files in a mode that its Python no longer has.
import_bvh.open = lambda name, mode: open(name, mode.replace("U", ""))
bpy.context.scene.render.fps = round(rate)
bpy.ops.import_anim.bvh(filepath=path, global_scale=1.0, update_scene_fps=True)
rig = next(o for o in bpy.context.scene.objects if o.type == "ARMATURE")
worst = furthest = 0.0
first = places(0)
for n in range(10):
    frame = (frames - 1) * n // 9
    bpy.context.scene.frame_set(1 + frame)
    for name, wanted in places(frame).items():
        if name in rig.pose.bones:
            found = rig.matrix_world @ rig.pose.bones[name].head
            there = Vector((wanted.x, -wanted.z, wanted.y))
            worst = max(worst, (found - there).length)
            furthest = max(furthest, (wanted - first[name]).length)
bones = len([b for b in rig.pose.bones if b.name != "Hands"])
if bones not in (21, 42) or worst > 0.01 or furthest < 1.0:
    sys.exit(f"{bones} joints, off by {worst:.4f} cm, moved by {furthest:.2f} cm")
print(f"hands: {bones} joints, off by {10 * worst:.4f} mm at most; they move by up to {10 * furthest:.1f} mm")
