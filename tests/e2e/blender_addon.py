# blender -b -P blender_addon.py -- FOLDER FPS: the add-on on a head that is there already. FOLDER has bare.glb, the take's
# export first.glb with first.pc2, and second.glb with second.pc2, of the same take after an edit. Says how far what is shown
# is off the point caches; exits with a word when something else is wrong.
import importlib.util
import math
import os
import random
import shutil
import socket
import struct
import sys

import bpy
from mathutils import Quaternion

sys.dont_write_bytecode = True
here = os.path.dirname(os.path.abspath(__file__))
sys.path.append(here)
from blender_cache import Cache, still

folder, fps = sys.argv[sys.argv.index("--") + 1:]
spec = importlib.util.spec_from_file_location("marotte_blender", os.path.join(here, "../../ui/blender/marotte_blender.py"))
addon = importlib.util.module_from_spec(spec)
spec.loader.exec_module(addon)


def need(what, truth):
    if not truth:
        sys.exit(f"not so: {what}")


def fails(action, word):
    try:
        action()
    except (RuntimeError, addon.Refused) as error:
        return need(f"it says {word}: {error}", word in str(error))
    sys.exit(f"not refused: {word}")


def path(name):
    return os.path.join(folder, name)


bpy.ops.wm.read_factory_settings(use_empty=True)
addon.register()
scene = bpy.context.scene
scene.render.fps = int(fps)

# ---- a head, as a person has it: the mesh, and one shape of its own ----
bpy.ops.import_scene.gltf(filepath=path("bare.glb"))
heads = [o for o in scene.objects if o.type == "MESH"]
for head in heads:
    if head.data.shape_keys:
        if head.data.shape_keys.animation_data:
            head.data.shape_keys.animation_data_clear()
        head.shape_key_clear()
    head.shape_key_add(name="Basis")
    own = head.shape_key_add(name="my own")
    own.data[0].co.x += 0.001
for action in list(bpy.data.actions):
    bpy.data.actions.remove(action)
cache = Cache(path("bare.glb"), path("first.pc2"))
still(heads)
need("the head is that of the cache", cache.find(heads) > 100)


def select(things):
    for o in scene.objects:
        o.select_set(o in things)


def strips():
    return [s for h in heads for t in (h.data.shape_keys.animation_data.nla_tracks
                                       if h.data.shape_keys.animation_data else []) for s in t.strips]


# ---- bad input ----
shutil.copy(path("first.glb"), path("take.glb"))
with open(path("take.glb"), "rb") as file:
    whole = file.read()
fails(lambda: addon.open_take(bpy.context, path("none.glb"), heads), "No such file")
for bad, word in ((b"", "not a .glb"), (whole[:200], "damaged"), (whole[:len(whole) // 2], "damaged"),
                  (whole.replace(b'"contentHash"', b'"contentHas_"'), "not a performance of marotte"),
                  (whole.replace(b'"targetNames"', b'"targetName_"'), "damaged")):
    with open(path("bad.glb"), "wb") as file:
        file.write(bad)
    fails(lambda: addon.open_take(bpy.context, path("bad.glb"), heads), word)
select([])
fails(lambda: bpy.ops.marotte.open_take(filepath=path("take.glb")), "no mesh is selected")
fails(lambda: addon.open_take(bpy.context, path("take.glb"), heads, adds=False), "none of the selected meshes")

# ---- a strip, and the take edited ----
there = {kind: len(getattr(bpy.data, kind)) for kind in addon.Visitor.KINDS}
scene.frame_set(10)
select(heads)
need("it is opened", bpy.ops.marotte.open_take(filepath=path("take.glb")) == {"FINISHED"})
for kind, count in there.items():
    need(f"nothing else stays: {kind}", kind == "actions" or len(getattr(bpy.data, kind)) == count)
need("one strip each", len(strips()) == len(heads) and all(s.frame_start == 10 for s in strips()))
need("its own shape is there", all("my own" in h.data.shape_keys.key_blocks for h in heads))
first = cache.off(lambda frame: 10 + frame)
print("strip: off by %.4f mm at most; the face moves by up to %.2f mm" % first)
shapes = [len(h.data.shape_keys.key_blocks) for h in heads]
need("opened again it is the same strip", bpy.ops.marotte.open_take(filepath=path("take.glb")) == {"FINISHED"}
     and len(strips()) == len(heads) and shapes == [len(h.data.shape_keys.key_blocks) for h in heads])

bpy.ops.marotte.update()
shutil.copy(path("second.glb"), path("take.glb"))
for strip in strips():
    strip.frame_start_ui = 25  # somebody has moved it
need("it is updated", addon.update_takes(bpy.context) == (len(heads), []))
need("the strip is where it was put", len(strips()) == len(heads) and all(s.frame_start == 25 for s in strips()))
cache.load(path("second.pc2"))
need("the strip is as long as the take", all(abs(s.action_frame_end - (cache.frames - 1)) < 1e-3 for s in strips()))
print("updated: off by %.4f mm at most; the face moves by up to %.2f mm" % cache.off(lambda frame: 25 + frame))
need("nothing is to be updated", addon.update_takes(bpy.context) == (0, []))
os.remove(path("take.glb"))
need("a file that is gone is told", "No such file" in addon.update_takes(bpy.context)[1][0])
shutil.copy(path("second.glb"), path("take.glb"))

# ---- as an action, on a head that has the shapes by their names and stands elsewhere ----
for strip in strips():
    strip.mute = True
heads[0].location.x += 1.0
scene.frame_set(3)
for head in heads:
    head.data.shape_keys.animation_data_clear()
need("as an action", bpy.ops.marotte.open_take(filepath=path("second.glb"), how="ACTION", adds=False) == {"FINISHED"})
heads[0].location.x -= 1.0
print("action: off by %.4f mm at most; the face moves by up to %.2f mm" % cache.off(lambda frame: 3 + frame))

# ---- live ----
def padded(data):
    return data + b"\0" * (4 - len(data) % 4)


def message(address, kinds="", *values):
    out = padded(address.encode()) + padded(b"," + kinds.encode())
    for kind, value in zip(kinds, values):
        out += padded(value.encode()) if kind == "s" else struct.pack(">" + kind, value)
    return out


def bundle(*messages, stamp=1):
    return b"#bundle\0" + struct.pack(">Q", stamp) + b"".join(struct.pack(">i", len(m)) + m for m in messages)


rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
scene.collection.objects.link(rig)
select([rig])
bpy.context.view_layer.objects.active = rig
bpy.ops.object.mode_set(mode="EDIT")
for name, tail in (("J_Bip_C_Head", (0, 0, 1)), ("eye.L", (0, -1, 0)), ("forehead", (1, 0, 0))):
    bone = rig.data.edit_bones.new(name)
    bone.head, bone.tail = (0, 0, 0), tail
bpy.ops.object.mode_set(mode="OBJECT")

head = heads[0]
head.data.shape_keys.animation_data_clear()
for key in head.data.shape_keys.key_blocks:
    key.value = 0
select([head, rig])
with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:  # somebody may send faces to the usual one
    free.bind(("127.0.0.1", 0))
    scene.marotte_port = free.getsockname()[1]
need("it listens", bpy.ops.marotte.live() == {"FINISHED"})
live = addon.live
fails(lambda: addon.Live("127.0.0.1", live.address[1], [head]), "cannot listen")
fails(lambda: addon.Live("127.0.0.1", 0, []), "select a mesh")
sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)


def send(packet, now_s):
    sender.sendto(packet, live.address)
    for _ in range(1000):  # loopback delivers at once, nearly
        if live.poll(now_s) or not packet.startswith((b"/", b"#")):
            return


key = head.data.shape_keys.key_blocks["my own"]
send(bundle(message("/VMC/Ext/OK", "i", 1), message("/VMC/Ext/T", "f", 100.0),
            message("/VMC/Ext/Blend/Val", "sf", "MyOwn", 0.75), message("/VMC/Ext/Blend/Apply")), 5.0)
need(f"a value is shown: {key.value}", abs(key.value - 0.75) < 1e-6)
sender.sendto(message("/VMC/Ext/Blend/Val", "sf", "My_Own", 0.25), live.address)
live.poll(5.0)
need("it waits for Apply", abs(key.value - 0.75) < 1e-6)
send(message("/marotte/1/face", "sfsf", "my own", 0.5, "nobody", 2.0), 5.1)
need("named floats", abs(key.value - 0.5) < 1e-6)
send(message("/marotte/1/face/my own", "f", 9.0), 5.2)
need("within what the key allows", key.value == key.slider_max)

# A nod by 90 degrees about Unity's x: the face, which looks to +z there, looks down; in Blender from -y to -z.
half = math.sqrt(0.5)
send(bundle(message("/VMC/Ext/Bone/Pos", "sfffffff", "Head", 0.0, 0.0, 0.0, half, 0.0, 0.0, half),
            message("/VMC/Ext/Bone/Pos", "sfffffff", "LeftEye", 0.0, 0.0, 0.0, 0.0, half, 0.0, half),
            message("/VMC/Ext/Blend/Apply")), 5.3)
bpy.context.view_layer.update()


def turned(name, along):
    bone = rig.pose.bones[name]
    return (bone.matrix @ bone.bone.matrix_local.inverted()).to_quaternion() @ along


from mathutils import Vector
need("the head nods", (turned("J_Bip_C_Head", Vector((0, -1, 0))) - Vector((0, 0, -1))).length < 1e-5)
# By 90 degrees about Unity's y: from +z to Unity's +x, which is Blender's -x.
need("the eye looks aside", (turned("eye.L", Vector((0, -1, 0))) - Vector((-1, 0, 0))).length < 1e-5)
need("the forehead does not", rig.pose.bones["forehead"].rotation_quaternion == Quaternion())

# Recorded with the sender's times, whatever the arrival was like.
scene.frame_set(1)
bpy.ops.marotte.record()
times = [200.0 + t for t in (0.0, 0.033, 0.071, 0.1, 0.5, 0.513)]
for i, t in enumerate(times):
    turn = math.sin(0.05 * i), 0.0, 0.0, math.cos(0.05 * i)
    send(bundle(message("/VMC/Ext/T", "f", t), message("/VMC/Ext/Blend/Val", "sf", "MyOwn", 0.1 * i),
                message("/VMC/Ext/Bone/Pos", "sfffffff", "Head", 0.0, 0.0, 0.0, *turn),
                message("/VMC/Ext/Blend/Apply")), 50.0 + t - 200.0 + (0.02 if i % 2 else 0.0))
bpy.ops.marotte.record()
action = head.data.shape_keys.animation_data.action
curves, _ = addon.curves_of(action, "KEY", "")
points = next(c for c in curves if "my own" in c.data_path).keyframe_points
need("a key for each", len(points) == len(times))
for point, t, i in zip(points, times, range(9)):
    need(f"at its true time: {point.co[0]}", abs(point.co[0] - (1 + (t - 200.0) * int(fps))) < 2e-3)
    need(f"with its value: {point.co[1]}", abs(point.co[1] - 0.1 * i) < 1e-6)
curves, _ = addon.curves_of(rig.animation_data.action, "OBJECT", "")
need("the head's turn, too", len([c for c in curves if "J_Bip_C_Head" in c.data_path]) == 4)
fails(lambda: bpy.ops.marotte.record() == bpy.ops.marotte.record(), "no faces were received")

# ---- hostile packets: nothing is shown, nothing ends ----
good = [bundle(message("/VMC/Ext/Blend/Val", "sf", "MyOwn", 0.3), message("/VMC/Ext/Blend/Apply")),
        message("/VMC/Ext/Bone/Pos", "sfffffff", "Head", *[math.nan] * 7), message("/VMC/Ext/T", "f", math.inf),
        message("/marotte/1/face", "sf", "a" * 500, 1.0), message("/VMC/Ext/Blend/Val", "sf", "x", math.nan),
        message("/VMC/Ext/Blend/Val", "fs", 1.0, "x"), message("/marotte/1/face", "s", "x"), b"", b"/", b"#bundle\0"]
deep = message("/marotte/1/face/x", "f", 1.0)
for _ in range(100):
    deep = bundle(deep)
need("too deep", addon.osc_read(deep) == [])
need("a size beyond the end", addon.osc_read(b"#bundle\0" + bytes(8) + struct.pack(">i", 1 << 30) + bytes(8)) == [])
need("a negative size", addon.osc_read(b"#bundle\0" + bytes(8) + struct.pack(">i", -4) + bytes(8)) == [])
need("a blob beyond the end", addon.osc_read(padded(b"/x") + padded(b",b") + struct.pack(">i", 1 << 30)) == [])
random.seed(1)
receiver = addon.Receiver()
for _ in range(20000):
    packet = bytearray(random.choice(good))
    for _ in range(random.randrange(4)):
        if packet:
            packet[random.randrange(len(packet))] = random.randrange(256)
    receiver.take(bytes(packet[:random.randrange(len(packet) + 1)] if random.random() < 0.3 else packet), random.random())
for i in range(2000):
    receiver.take(message(f"/marotte/1/face/n{i}", "f", 1.0), 3.0)
need("names have an end", len(receiver.face.values) <= addon.NAMES_MAX and
     all(math.isfinite(v) for v in receiver.face.values.values()) and receiver.ignored > 1000)
bpy.data.objects.remove(head)
send(good[0], 80.0)  # what it moved is gone
need("it ends", bpy.ops.marotte.live() == {"FINISHED"} and addon.live is None)
addon.unregister()
print("live: values, turns, true times; hostile packets are ignored")
