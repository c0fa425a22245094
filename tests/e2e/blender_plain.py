# python3 blender_plain.py: what the Blender add-on does with files and packets of anybody, without Blender: with a stand-in
# for what it asks of it. Exits with a word when something is not so.
import contextlib
import importlib.util
import io
import json
import os
import random
import select
import socket
import struct
import sys
import tempfile
import types

sys.dont_write_bytecode = True
PATIENCE_S = 60.0


def need(what, truth):
    if not truth:
        sys.exit(f"not so: {what}")


# ---- Blender, as far as it is asked ----

class Anything:
    def __init__(self, *_, **__):
        pass


def nothing(*_, **__):
    return None


def module(name, **members):
    out = types.ModuleType(name)
    vars(out).update(members)
    sys.modules[name] = out
    return out


module("numpy")
module("mathutils", Matrix=Anything, Quaternion=Anything, kdtree=Anything)
module("bpy_extras")
module("bpy_extras.io_utils", ImportHelper=type("ImportHelper", (), {}))
props = module("bpy.props", BoolProperty=nothing, EnumProperty=nothing, IntProperty=nothing, StringProperty=nothing)
scene = types.SimpleNamespace(objects=[], marotte_follow=True, frame_current=1,
                              render=types.SimpleNamespace(fps=24, fps_base=1.0))
bpy = module("bpy", props=props, path=types.SimpleNamespace(abspath=lambda path: path),
             types=types.SimpleNamespace(Operator=type("Operator", (), {}), Panel=type("Panel", (), {}), Scene=Anything),
             app=types.SimpleNamespace(timers=None), data=types.SimpleNamespace(actions=[]),
             context=types.SimpleNamespace(scene=scene, selected_objects=[]))
spec = importlib.util.spec_from_file_location("marotte_blender", os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "../../ui/blender/marotte_blender.py"))
addon = importlib.util.module_from_spec(spec)
spec.loader.exec_module(addon)

# ---- live faces: packets ----


def padded(data):
    return data + b"\0" * (4 - len(data) % 4)


def face_packet(*values):
    out = padded(b"/marotte/1/face") + padded(b"," + b"sf" * len(values))
    for i, value in enumerate(values):
        out += padded(b"n%d" % i) + struct.pack(">f", value)
    return out


def open_live():
    rig = types.SimpleNamespace(type="ARMATURE", name="rig", pose=types.SimpleNamespace(bones=[]))
    live = addon.Live("127.0.0.1", 0, [rig])
    live.shown = []
    live.show = lambda face: live.shown.append(dict(face.values))
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sender.connect(live.address)
    return live, sender


def has_more(live):
    return bool(select.select([live.socket], [], [], PATIENCE_S)[0])


def bytes_have_a_budget():
    live, sender = open_live()
    for _ in range(3):
        sender.send(b"/" + b"x" * 40000)
    need("something comes", has_more(live))
    live.poll(1.0)
    need(f"at most {addon.TICK_BYTES} bytes and a packet in a tick: {live.receiver.packets}", live.receiver.packets <= 2)
    while live.receiver.packets < 3:
        need("the rest has waited", has_more(live))
        live.poll(1.0)
    live.close()


def time_has_a_budget_and_the_newest_face_wins():
    live, sender = open_live()
    for i in range(20):
        sender.send(face_packet(i / 32))
    need("something comes", has_more(live))
    live.poll(1.0)
    need("one show in a tick", len(live.shown) == 1)
    while live.shown[-1]["n0"] != 19 / 32:
        need("the newest comes", has_more(live))
        live.poll(1.0)
    ticks = iter(range(100000))
    addon.time = types.SimpleNamespace(monotonic=lambda: float(next(ticks)))  # each look at the clock: a second later
    for i in range(5):
        sender.send(face_packet(i / 32))
    for i in range(5):
        need("it waits", has_more(live))
        before = live.receiver.packets
        live.poll()
        need("no more than one when it takes long", live.receiver.packets == before + 1)
        need("in their order", live.shown[-1]["n0"] == i / 32)
    live.close()


def recording_has_an_end():
    live, sender = open_live()
    addon.RECORDED_VALUES_MAX = 100
    said = io.StringIO()
    live.record()
    with contextlib.redirect_stdout(said):
        for i in range(40):
            sender.send(face_packet(*[i / 64] * 10))
            while live.receiver.packets <= i:
                need("it comes", has_more(live))
                live.poll(float(i))
    need(f"not more is kept: {len(live.recorded)}", 5 <= len(live.recorded) <= 10)
    need("what came first is kept", live.recorded[0].values["n0"] == 0.0)
    need("it is shown on", live.shown[-1]["n0"] == 39 / 64)
    need(f"it is told once: {said.getvalue()}", said.getvalue().count("full") == 1)
    live.record()
    need("another one begins empty", live.recorded == [] and not live.is_full)
    live.close()


# ---- files ----

folder = tempfile.TemporaryDirectory()
GOOD = {
    "animations": [{"extras": {"contentHash": "abc", "take": {"show": "s", "id": 7, "slate": "1/a"}},
                    "channels": [{"target": {"path": "weights", "node": 0}, "sampler": 0}],
                    "samplers": [{"input": 0, "output": 1}]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"extras": {"targetNames": ["jaw", "jaw"]}}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "type": "SCALAR", "count": 2},
                  {"bufferView": 1, "componentType": 5126, "type": "SCALAR", "count": 4}],
    "bufferViews": [{"byteOffset": 0}, {"byteOffset": 8}],
}


def write(text, name="take.glb"):
    path = os.path.join(folder.name, name)
    head = text.encode()
    binary = struct.pack("<6f", 0.0, 1.0, 0.5, 0.25, 0.5, 0.75)
    with open(path, "wb") as file:
        file.write(b"glTF" + struct.pack("<II", 2, 0) + struct.pack("<I", len(head)) + b"JSON" + head +
                   struct.pack("<I", len(binary)) + b"BIN\0" + binary)
    return path


def good_text(**changed):
    return json.dumps(GOOD).replace('"id": 7', f'"id": {changed.get("id", 7)}').replace(
        '"abc"', json.dumps(changed.get("hash", "abc")))


def refused(text):
    try:
        addon.Export(write(text))
    except addon.Refused:
        return True
    return False


def a_take_is_read():
    export = addon.Export(write(good_text()))
    need("its id", export.take == "s#7")
    need("names that are there twice", export.weights == {"jaw": (0.5, 0.5), "jaw.001": (0.25, 0.75)})


def an_id_is_a_whole_number():
    for bad in ("1e999", "-1e999", "NaN", "-1", "1.5", '"7"', "true", "null", "[]", "1" * 400, str(1 << 64)):
        need(f'"id": {bad} is refused', refused(good_text(id=bad)))


def numbers_of_a_file_may_be_any():
    odd = ["1e999", "-1", "NaN", "1e30", str(10**30), '"x"', "[]", "{}", "null", "true", "0.5", str(1 << 62)]
    text = good_text()
    places = [i for i, letter in enumerate(text) if letter.isdigit() and not text[i - 1].isdigit()]
    random.seed(2)
    for place in places:
        end = place
        while text[end].isdigit():
            end += 1
        for number in odd:
            refused(text[:place] + number + text[end:])  # or it is read: nothing else is raised


def what_is_no_file_is_not_waited_for():
    path = os.path.join(folder.name, "pipe.glb")
    os.mkfifo(path)
    try:
        addon.Export(path)
    except addon.Refused as error:
        return need(f"it is told: {error}", "pipe.glb" in str(error))
    sys.exit("not refused: a pipe")


# ---- what a .blend names is not looked at by itself ----


class Action(dict):
    pass


def looked_at(action):
    seen = []
    real = os.stat

    def stat(path, *more, **named):
        seen.append(path)
        return real(path, *more, **named)
    os.stat = stat
    try:
        action()
    finally:
        os.stat = real
    return seen


def a_path_of_a_blend_is_only_looked_at_when_the_person_says_so():
    path = write(good_text(), "linked.glb")
    bpy.data.actions = [Action({addon.TAKE: "s#7", addon.HASH: "abc", addon.FILE: path}),
                        Action({addon.TAKE: "x", addon.HASH: "x", addon.FILE: "//elsewhere.example/share/take.glb"})]
    need("nothing is looked at", looked_at(addon.tick_follow) == [])
    with contextlib.suppress(addon.Refused):  # of the other one it says that it is not there
        addon.MAROTTE_OT_update().run(bpy.context)  # "Update Takes"
    need("then what it found is followed, and nothing else", set(looked_at(addon.tick_follow)) == {path})
    updated = []
    addon.open_take = lambda context, path, *_: updated.append(path)
    os.utime(write(good_text(hash="new"), "linked.glb"), ns=(5, 5))
    addon.tick_follow()
    need(f"it is updated when it changes: {updated}", updated == [path])
    bpy.data.actions = []
    need("another file that names nothing", looked_at(addon.tick_follow) == [])


for claim in (a_take_is_read, an_id_is_a_whole_number, numbers_of_a_file_may_be_any, what_is_no_file_is_not_waited_for,
              a_path_of_a_blend_is_only_looked_at_when_the_person_says_so, bytes_have_a_budget, recording_has_an_end,
              time_has_a_budget_and_the_newest_face_wins):
    claim()
print("the add-on, without Blender: files, packets and paths of anybody")
