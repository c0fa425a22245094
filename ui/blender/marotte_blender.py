# SPDX-License-Identifier: MIT
"""marotte for Blender: takes on an existing head, and live faces.

The export of a take (.glb) becomes an action or an NLA strip on the shape keys of the selected meshes, by their names.
If the mesh is that of the export, missing shape keys are added. When the take is edited and exported again, the strip is
updated in place. Faces that arrive by VMC, or as named floats in OSC, are shown and recorded with the times of their
performance. One file, for Blender 3.4 and later. README.md in this folder is the guide.

In reading order: F-curves in every Blender, exports, takes on heads, OSC, live faces, operators and the panel.
"""

import json
import math
import os
import re
import socket
import stat
import struct
import sys
import time

import bpy
import numpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper
from mathutils import Matrix, Quaternion, kdtree

bl_info = {
    "name": "marotte",
    "author": "the marotte project",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > marotte",
    "description": "Takes and live faces from marotte on existing heads",
    "category": "Animation",
}


class Refused(Exception):
    """An error message for the user: a file or a scene that cannot be used, and the reason."""


# ---- F-curves in all versions of Blender: 4.4 added slots to actions, 5.0 has only slots ----


def curves_of(action, id_type, name):
    """Returns the F-curves of an action for one kind of data ('KEY', 'OBJECT'), and the slot to play them, or None."""
    if not hasattr(action, "slots"):
        return action.fcurves, None
    slot = next((s for s in action.slots if s.target_id_type in (id_type, "UNSPECIFIED")), None)
    slot = slot or action.slots.new(id_type=id_type, name=name)
    layer = action.layers[0] if len(action.layers) else action.layers.new("Layer")
    strip = layer.strips[0] if len(layer.strips) else layer.strips.new(type="KEYFRAME")
    return strip.channelbag(slot, ensure=True).fcurves, slot


def play(owner, action, slot):
    data = owner.animation_data_create()
    data.action = action
    if slot is not None:
        data.action_slot = slot


def put_curve(curves, path, index, frames, values):
    curve = curves.new(data_path=path, index=index)
    curve.keyframe_points.add(len(frames))
    curve.keyframe_points.foreach_set("co", [n for pair in zip(frames, values) for n in pair])
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"
    curve.update()


def value_path(key_name):
    return f'key_blocks["{bpy.utils.escape_identifier(key_name)}"].value'


# ---- exports: .glb files of marotte ----

JSON_BYTES_MAX = 256 << 20
ID_MAX = (1 << 63) - 1
FLOAT = 5126


class Export:
    """The curves of a .glb of marotte: for each name of a target its weights over time."""

    def __init__(self, path):
        self.path = os.path.abspath(bpy.path.abspath(path))
        try:
            if not stat.S_ISREG(os.stat(self.path).st_mode):  # reading a pipe would block
                raise Refused(f"{path}: not a .glb file")
            with open(self.path, "rb") as file:
                head = file.read(20)
                if len(head) < 20 or head[:4] != b"glTF" or head[16:20] != b"JSON":
                    raise Refused(f"{path}: not a .glb file")
                length = struct.unpack_from("<I", head, 12)[0]
                if length > JSON_BYTES_MAX:
                    raise Refused(f"{path}: too large")
                self.json = json.loads(file.read(length))
                self.binary = file.read()[8:]
            self.stamp = os.stat(self.path).st_mtime_ns
            self.read()
        except Refused:
            raise
        except OSError as error:
            raise Refused(f"{path}: {error.strerror}") from error
        except (ValueError, KeyError, IndexError, TypeError, AttributeError, ArithmeticError, MemoryError, struct.error,
                RecursionError) as error:
            raise Refused(f"{path}: damaged") from error

    def read(self):
        animations = [a for a in self.json.get("animations", []) if "contentHash" in a.get("extras", {})]
        if not animations:
            raise Refused(f"{self.path}: not a performance of marotte, or one of an older version")
        animation = animations[0]
        extras = animation["extras"]
        take = extras.get("take", {})
        stem = os.path.splitext(os.path.basename(self.path))[0]
        self.hash = str(extras["contentHash"])
        self.name = str(take.get("slate") or stem)
        if "show" in take and not (type(take["id"]) is int and 0 <= take["id"] <= ID_MAX):
            raise ValueError("id")
        self.take = f'{take["show"]}#{take["id"]}' if "show" in take else self.path
        self.times, self.weights = [], {}
        for channel in animation["channels"]:
            if channel["target"].get("path") != "weights":
                continue
            sampler = animation["samplers"][channel["sampler"]]
            mesh = self.json["meshes"][self.json["nodes"][channel["target"]["node"]]["mesh"]]
            names = [str(n) for n in mesh["extras"]["targetNames"]]
            times, values = self.floats(sampler["input"]), self.floats(sampler["output"])
            if len(values) != len(times) * len(names) or not names:
                raise ValueError("weights")
            self.times = times
            times_seen = {}
            for i, name in enumerate(names):
                before = times_seen.get(name, 0)
                times_seen[name] = before + 1
                if before:  # Blender's name for a duplicate
                    name = f"{name}.{before:03}"
                if any(values[i::len(names)]) or name not in self.weights:  # several meshes may have the same name
                    self.weights[name] = values[i::len(names)]
        if not self.weights or not self.times:
            raise ValueError("no weights")

    def floats(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        if accessor["componentType"] != FLOAT or accessor["type"] != "SCALAR" or view.get("byteStride", 4) != 4:
            raise ValueError("accessor")
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        numbers = struct.unpack_from(f"<{accessor['count']}f", self.binary, start)
        if not all(map(math.isfinite, numbers)):
            raise ValueError("not finite")
        return numbers


# ---- takes on heads ----

# Custom properties. An action has its take, file and hash of the content. A mesh has the shape keys that takes added,
# each with its takes.
TAKE, HASH, FILE, OWNED = "marotte_take", "marotte_hash", "marotte_file", "marotte_shapes"
TRACK = "marotte"


def frames_a_second(scene):
    return scene.render.fps / scene.render.fps_base


def owned_shapes(mesh):
    """Returns the takes that added each shape key, by the name of the key."""
    try:
        owned = json.loads(mesh.get(OWNED, "{}"))
        return {str(k): [str(t) for t in v] for k, v in owned.items()} if isinstance(owned, dict) else {}
    except (ValueError, TypeError):
        return {}


class Visitor:
    """The objects of a file, imported temporarily and removed completely."""

    KINDS = ("objects", "meshes", "materials", "images", "actions", "armatures", "cameras", "lights", "collections",
             "textures", "node_groups", "curves")

    def __init__(self, context, path):
        self.context, self.path = context, path

    def __enter__(self):
        if "bool" not in vars(numpy):  # Debian 12's importer uses a name that its NumPy no longer has
            numpy.bool = bool
        view = self.context.view_layer
        scene = self.context.scene
        self.before = {kind: set(getattr(bpy.data, kind)) for kind in self.KINDS}
        self.active, self.selected = view.objects.active, [o for o in view.objects if o.select_get()]
        self.frames = scene.frame_start, scene.frame_end, scene.frame_current
        try:
            bpy.ops.import_scene.gltf(filepath=self.path)
        except RuntimeError as error:
            self.__exit__()
            raise Refused(f"{self.path}: {str(error).strip().splitlines()[-1]}") from error
        return [o for o in bpy.data.objects if o not in self.before["objects"] and o.type == "MESH"]

    def __exit__(self, *_):
        for kind in self.KINDS:
            new = [block for block in getattr(bpy.data, kind) if block not in self.before[kind]]
            bpy.data.batch_remove(new)
        scene = self.context.scene
        scene.frame_start, scene.frame_end, scene.frame_current = self.frames
        for o in self.selected:
            o.select_set(True)
        self.context.view_layer.objects.active = self.active


def places_of(points):
    flat = numpy.empty(3 * len(points), numpy.float32)
    points.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(numpy.float64)


def rest_of(thing):
    keys = thing.data.shape_keys
    return places_of(keys.reference_key.data if keys else thing.data.vertices)


def size_of(places):
    return float(numpy.ptp(places, axis=0).max()) or 1.0


def same_places(head, source):
    """For each vertex of a head that of the source at its place, and how the source's axes turn into the head's; None:
    they are not of one mesh. Both may be where they like in the scene, or moved alike."""
    of_head, of_source = rest_of(head), rest_of(source)
    if not len(of_head) or not len(of_source):
        return None
    near = 1e-4 * size_of(of_head)
    for turn in (Matrix.Identity(4), head.matrix_world.inverted_safe() @ source.matrix_world):
        axes = numpy.array(turn.to_3x3())
        placed = of_source @ axes.T + numpy.array(turn.to_translation())
        if placed.shape == of_head.shape and numpy.abs(placed - of_head).max() < near:
            return numpy.arange(len(placed)), axes
        tree = kdtree.KDTree(len(placed))
        for i, place in enumerate(placed):
            tree.insert(place, i)
        tree.balance()
        found = [tree.find(place) for place in of_head]
        if all(distance < near for _, _, distance in found):
            return numpy.array([index for _, index, _ in found]), axes
    return None


def put_shape(head, name, offsets, take):
    """Returns the shape key of a head with these offsets for a take. A key of the head itself is not changed. A key that
    only this take added is updated. A different key of another take is kept, and a second key is added."""
    owned = owned_shapes(head.data)
    if not head.data.shape_keys:
        head.shape_key_add(name="Basis", from_mix=False)
    blocks = head.data.shape_keys.key_blocks
    wanted = rest_of(head) + offsets
    for called in (name, f"{name[:30]} ({take[-28:]})"):
        block = blocks.get(called)
        if block is None:
            block = head.shape_key_add(name=called, from_mix=False)
            owned[block.name] = []
        elif called in owned and owned[called] != [take]:
            if numpy.abs(places_of(block.data) - wanted).max() > 1e-5 * size_of(wanted):
                continue
        break
    if block.name in owned:
        block.data.foreach_set("co", wanted.astype(numpy.float32).ravel())
        owned[block.name] = sorted({*owned[block.name], take})
        head.data[OWNED] = json.dumps(owned)
    return block.name


def drop_shapes(head, take, kept):
    """Removes shape keys that only this take added, and that it no longer needs."""
    owned = owned_shapes(head.data)
    for name, takes in list(owned.items()):
        if take not in takes or name in kept:
            continue
        takes.remove(take)
        block = head.data.shape_keys.key_blocks.get(name) if head.data.shape_keys else None
        if not takes:
            del owned[name]
            if block:
                head.shape_key_remove(block)
    head.data[OWNED] = json.dumps(owned)


def plainly(name):
    """Returns the same text for all spellings of a name: JawOpen, jawOpen, jaw_open, jaw.open."""
    return "".join(filter(str.isalnum, name)).lower()


def keys_by_name(keys):
    """Returns a function that finds a shape key by its exact name, else by another spelling; never the basis."""
    blocks = [b for b in keys.key_blocks if b != keys.reference_key]
    exact, plain = {b.name: b for b in blocks}, {plainly(b.name): b for b in reversed(blocks) if plainly(b.name)}
    return lambda name: exact.get(name) or plain.get(plainly(name))


def actions_of(take, keys):
    return [a for a in bpy.data.actions if a.get(TAKE) == take and a.get("marotte_of") == keys.name]


def put_strip(keys, action, slot, start, length):
    """Adds a strip for an action, or updates the existing one, and keeps its place and scale."""
    data = keys.animation_data_create()
    for track in data.nla_tracks:
        for strip in track.strips:
            if strip.action == action:
                strip.action_frame_start, strip.action_frame_end = 0.0, length
                return
    for track in [t for t in data.nla_tracks if t.name.startswith(TRACK)] + [None]:
        track = track or data.nla_tracks.new()
        if not track.name.startswith(TRACK):
            track.name = TRACK
        try:
            strip = track.strips.new(action.name, int(start), action)
        except RuntimeError:  # it would overlap other strips
            continue
        if slot is not None:
            strip.action_slot = slot
        strip.action_frame_start, strip.action_frame_end = 0.0, length
        return


def bring_shapes(context, export, heads):
    """Adds missing shapes of the export to the heads. Returns, for each head, the names of the keys by the names of the
    targets, and messages about shapes that could not be added."""
    called = {head: {} for head in heads}
    news = []
    own = {head: set(head.data.shape_keys.key_blocks.keys() if head.data.shape_keys else ()) -
           set(owned_shapes(head.data)) for head in heads}
    if all(not (set(export.weights) - own[head]) for head in heads):
        return called, news
    with Visitor(context, export.path) as sources:
        for head in heads:
            alike = head.name.split(".")[0]
            for source in sorted(sources, key=lambda s: s.name.split(".")[0] != alike):
                places = same_places(head, source)
                if places is None:
                    continue
                index, axes = places
                rest = rest_of(source)
                for block in source.data.shape_keys.key_blocks[1:] if source.data.shape_keys else []:
                    if block.name not in export.weights or block.name in own[head]:
                        continue
                    offsets = ((places_of(block.data) - rest) @ axes.T)[index]
                    if offsets.any():
                        called[head][block.name] = put_shape(head, block.name, offsets, export.take)
                drop_shapes(head, export.take, set(called[head].values()))
                break
            else:
                news.append(f"{head.name} is not the mesh of the export. Only shape keys with the same names move")
    return called, news


def open_take(context, path, heads, how="STRIP", start=None, adds=True):
    """Adds an export as an action or a strip on the shape keys of these meshes. Returns a message about the result."""
    export = Export(path)
    scene = context.scene
    start = scene.frame_current if start is None else start
    rate = frames_a_second(scene)
    if not heads:
        raise Refused("no mesh is selected")
    called, news = bring_shapes(context, export, heads) if adds else ({h: {} for h in heads}, [])
    moved, missing = 0, set(export.weights)
    seen = set()
    for head in heads:
        keys = head.data.shape_keys
        if not keys or keys.name in seen:
            continue
        seen.add(keys.name)
        curves, key_named = {}, keys_by_name(keys)
        for name, values in export.weights.items():
            key = key_named(called[head].get(name, name))
            if key is not None:
                curves[key.name] = values
                missing.discard(name)
        if not curves:
            continue
        action = next(iter(actions_of(export.take, keys)), None) or bpy.data.actions.new(f"{export.name} {head.name}")
        action[TAKE], action[HASH], action[FILE], action["marotte_of"] = export.take, export.hash, export.path, keys.name
        action.use_fake_user = True
        of_action, slot = curves_of(action, "KEY", keys.name)
        is_strip = how == "STRIP"
        frames = [t * rate + (0.0 if is_strip else start) for t in export.times]
        for curve in list(of_action):
            of_action.remove(curve)
        for name, values in curves.items():
            put_curve(of_action, value_path(name), 0, frames, values)
        if is_strip:
            put_strip(keys, action, slot, start, frames[-1])
        else:
            action["marotte_start"] = float(start)
            play(keys, action, slot)
        moved += 1
    followed[export.path] = export.stamp
    if moved == 0:
        raise Refused("; ".join(news) or "none of the selected meshes has a shape key with a name of the export")
    if missing:
        news.append(f"no shape key is named {', '.join(sorted(missing)[:4])}{' ...' if len(missing) > 4 else ''}")
    return "; ".join([f"{export.name} moves {moved} mesh{'es' if moved > 1 else ''}"] + news)


def update_takes(context, paths=None):
    """Updates all actions whose file has changed: those of these paths, or all paths in the .blend when the user presses
    "Update Takes". Returns the number of updated actions, and error messages."""
    updated, news = 0, []
    stale = {}
    for action in bpy.data.actions:
        path = action.get(FILE)
        if not isinstance(path, str) or not isinstance(action.get(TAKE), str) or (paths is not None and path not in paths):
            continue
        try:
            export = Export(path)
            followed[path] = export.stamp
            if export.hash != action.get(HASH):
                stale.setdefault((path, action[TAKE]), []).append(action)
        except Refused as error:
            news.append(str(error))
    for (path, take), actions in stale.items():
        names = {a.get("marotte_of") for a in actions}
        heads = [o for o in context.scene.objects
                 if o.type == "MESH" and o.data.shape_keys and o.data.shape_keys.name in names]
        starts = [a["marotte_start"] for a in actions if "marotte_start" in a]
        try:
            if Export(path).take != take:
                raise Refused(f"{path}: the file contains another take now")
            open_take(context, path, heads, "ACTION" if starts else "STRIP", starts[0] if starts else None)
            updated += len(actions)
        except Refused as error:
            news.append(str(error))
    return updated, news


# ---- OSC: https://opensoundcontrol.stanford.edu, 1.0; damaged packets are ignored ----

PACKET_MAX, DEPTH_MAX, ARGUMENTS_MAX = 65536, 8, 1024
IMMEDIATELY = 1


class Damaged(Exception):
    pass


def osc_text(data, at):
    end = data.find(b"\0", at)
    if end < 0:
        raise Damaged
    next_at = (end // 4 + 1) * 4
    if next_at > len(data):
        raise Damaged
    return data[at:end].decode("utf-8"), next_at


def osc_message(data):
    address, at = osc_text(data, 0)
    if not address.startswith("/"):
        raise Damaged
    if at == len(data):
        return address, []
    kinds, at = osc_text(data, at)
    if not kinds.startswith(",") or len(kinds) > ARGUMENTS_MAX:
        raise Damaged
    arguments = []
    for kind in kinds[1:]:
        if kind in "ifhdt":
            form = {"i": ">i", "f": ">f", "h": ">q", "d": ">d", "t": ">Q"}[kind]
            arguments.append(struct.unpack_from(form, data, at)[0])
            at += struct.calcsize(form)
        elif kind in "sS":
            text, at = osc_text(data, at)
            arguments.append(text)
        elif kind == "b":
            size = struct.unpack_from(">i", data, at)[0]
            at += 4 + (size + 3) // 4 * 4
            if size < 0 or at > len(data):
                raise Damaged
            arguments.append(None)
        elif kind in "TFNI":
            arguments.append({"T": True, "F": False}.get(kind))
        else:
            raise Damaged
    return address, arguments


def osc_messages(data, stamp=IMMEDIATELY, depth=0):
    """Yields (time tag, address, arguments) of each message of a packet."""
    if not data.startswith(b"#bundle\0"):
        yield (stamp, *osc_message(data))
        return
    if depth == DEPTH_MAX or len(data) < 16:
        raise Damaged
    stamp, at = struct.unpack_from(">Q", data, 8)[0], 16
    while at < len(data):
        size = struct.unpack_from(">i", data, at)[0]
        at += 4
        if size <= 0 or size % 4 or at + size > len(data):
            raise Damaged
        yield from osc_messages(data[at:at + size], stamp, depth + 1)
        at += size


def osc_read(data):
    """Returns the messages of a packet; none if any part of it is damaged."""
    if len(data) > PACKET_MAX:
        return []
    try:
        return list(osc_messages(data))
    except (Damaged, struct.error, UnicodeDecodeError, RecursionError):
        return []


# ---- live faces ----

NAMES_MAX, NAME_MAX = 512, 64
TURNING = {"head": {"head"}, "neck": {"neck"}, "jaw": {"jaw", "jawmaster"},
           "lefteye": {"lefteye", "eyeleft", "leye", "eyel"}, "righteye": {"righteye", "eyeright", "reye", "eyer"}}
NO_PART_OF_A_NAME = {"j", "c", "bip", "adj", "def", "org", "mixamorig", "face", "bone"}
BEHIND_MAX_S = 0.5
# Limits of one tick, so that the window stays responsive; other packets wait in the socket.
TICK_S, TICK_BYTES = 0.004, 65536
# Limit of a recording in memory: 20 minutes of 52 shapes at 60 faces a second, some 300 MB.
RECORDED_VALUES_MAX = 4_000_000


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


def is_name(value):
    return isinstance(value, str) and 0 < len(value) <= NAME_MAX and value.isprintable()


class Face:
    """A received face: values by name, rotations of bones by name, and its time in seconds of the receiver's clock."""

    def __init__(self):
        self.values, self.turns, self.time = {}, {}, 0.0


class Receiver:
    """Converts packets to faces. VMC: /VMC/Ext/Blend/Val name value ... /VMC/Ext/Blend/Apply, /VMC/Ext/Bone/Pos name
    position rotation of Head, Neck, Jaw, LeftEye, RightEye, /VMC/Ext/T seconds. Named floats: /marotte/1/face name value,
    in one or many messages, or /marotte/1/face/NAME value; they are complete at the end of their packet."""

    def __init__(self):
        self.face = Face()       # current face
        self.coming = {}         # values that wait for Apply
        self.sender_s = None     # last time of the sender's clock since the last face
        self.anchor = None       # (sender, receiver): times of the same moment
        self.shown_s = -math.inf
        self.packets = self.ignored = 0

    def moment(self, stamp, now_s):
        """Returns the time of performance of a packet: by the sender's clock if possible, because arrival has jitter."""
        sender_s, self.sender_s = self.sender_s, None
        if sender_s is None and stamp != IMMEDIATELY:
            sender_s = stamp / 2.0**32
        if sender_s is None:
            return now_s
        if self.anchor is None or abs(sender_s - self.anchor[0] - (now_s - self.anchor[1])) > BEHIND_MAX_S:
            self.anchor = sender_s, now_s
        return self.anchor[1] + sender_s - self.anchor[0]

    def take(self, packet, now_s):
        """Reads a packet. Returns a new face, or None."""
        messages = osc_read(packet)
        self.packets += 1
        self.ignored += not messages
        is_new, stamp = False, IMMEDIATELY
        for stamp, address, arguments in messages:
            is_new = self.hear(address, arguments) or is_new
        if not is_new:
            return None
        face = Face()
        face.time = self.moment(stamp, now_s)
        if face.time <= self.shown_s:
            face.time = self.shown_s + 1e-6
        self.shown_s = face.time
        face.values, face.turns = dict(self.face.values), dict(self.face.turns)
        return face

    def put(self, into, name, value):
        if is_name(name) and (name in into or len(into) < NAMES_MAX):
            into.pop(name, None)  # the last value comes last, and is used if two names match one key
            into[sys.intern(name)] = value

    def hear(self, address, arguments):
        """Reads a message. Returns whether it completes a face."""
        if address == "/VMC/Ext/Blend/Val":
            if len(arguments) == 2 and is_number(arguments[1]):
                self.put(self.coming, arguments[0], float(arguments[1]))
        elif address == "/VMC/Ext/Blend/Apply":
            for name, value in self.coming.items():
                self.put(self.face.values, name, value)
            self.coming.clear()
            return True
        elif address == "/VMC/Ext/Bone/Pos":
            if len(arguments) == 8 and all(map(is_number, arguments[1:])) and is_name(arguments[0]):
                name = arguments[0].lower()
                x, y, z, w = arguments[4:]
                length = math.sqrt(x * x + y * y + z * z + w * w)
                if name in TURNING and 0.5 < length < 2.0:
                    # From Unity's axes (left-handed, y up, the face looks to +z) into Blender's (z up, to -y).
                    self.face.turns[name] = Quaternion((w, x, z, -y)).normalized()
        elif address == "/VMC/Ext/T":
            if len(arguments) == 1 and is_number(arguments[0]):
                self.sender_s = float(arguments[0])
        elif address == "/marotte/1/face":
            pairs = list(zip(arguments[::2], arguments[1::2]))
            if len(arguments) % 2 == 0 and all(is_number(value) for _, value in pairs):
                for name, value in pairs:
                    self.put(self.face.values, name, float(value))
                return bool(pairs)
        elif address.startswith("/marotte/1/face/") and len(arguments) == 1 and is_number(arguments[0]):
            self.put(self.face.values, address[len("/marotte/1/face/"):], float(arguments[0]))
            return True
        return False


def turn_of_bone(bone, turn):
    """Converts a rotation: VMC uses the parent's axes at rest, which are the world's; Blender uses the bone's axes."""
    rest = bone.matrix_local.to_quaternion()
    return rest.inverted() @ turn @ rest


def bones_of(rig):
    """Returns the bones that a face turns, by VMC's names: "Head", "J_Adj_L_FaceEye", "DEF-eye.L"."""
    out = {}
    for bone in rig.pose.bones:
        words = [w.lower() for w in re.findall("[A-Z]?[a-z]+|[A-Z]+(?![a-z])", bone.name)]
        plain = "".join(w for w in words if w not in NO_PART_OF_A_NAME)
        for name, others in TURNING.items():
            if plain in others:
                out.setdefault(name, bone)
    return out


class Live:
    """A socket, the meshes and rigs that its faces move, and the current recording."""

    def __init__(self, host, port, things):
        self.receiver = Receiver()
        self.heads = [o for o in things if o.type == "MESH" and o.data.shape_keys]
        self.rigs = [o for o in things if o.type == "ARMATURE"]
        for head in self.heads:
            rig = head.find_armature()
            if rig and rig not in self.rigs:
                self.rigs.append(rig)
        if not self.heads and not self.rigs:
            raise Refused("select a mesh with shape keys, or a rig")
        self.recorded = None  # faces
        self.recorded_values, self.is_full = 0, False
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self.socket.bind((host, port))
        except OSError as error:
            self.socket.close()
            raise Refused(f"cannot listen to {host}:{port}: {error.strerror}") from error
        self.socket.setblocking(False)
        self.address = self.socket.getsockname()

    def close(self):
        self.socket.close()

    def poll(self, now_s=None):
        """Reads the packets that have arrived, and shows the newest face. Returns whether a face arrived."""
        newest, size = None, 0
        until_s = time.monotonic() + TICK_S
        while size < TICK_BYTES:
            try:
                packet = self.socket.recv(PACKET_MAX)
            except OSError:
                break
            size += len(packet)
            face = self.receiver.take(packet, time.monotonic() if now_s is None else now_s)
            if face is not None:
                newest = face
                if self.recorded is not None:
                    self.keep(face)
            if time.monotonic() >= until_s:
                break
        if newest is not None:
            self.show(newest)
        return newest is not None

    def keys_of(self, head, face):
        """Returns the values of the shape keys of a head, by their names."""
        out, key_named = {}, keys_by_name(head.data.shape_keys)
        for name, value in face.values.items():
            key = key_named(name)
            if key is not None:
                out[key.name] = min(max(value, key.slider_min), key.slider_max)
        return out

    def show(self, face):
        try:
            for head in self.heads:
                for name, value in self.keys_of(head, face).items():
                    head.data.shape_keys.key_blocks[name].value = value
            for rig in self.rigs:
                for name, bone in bones_of(rig).items():
                    if name in face.turns:
                        bone.rotation_mode = "QUATERNION"
                        bone.rotation_quaternion = turn_of_bone(bone.bone, face.turns[name])
        except ReferenceError:  # an object was deleted
            self.heads, self.rigs = [], []

    def record(self):
        self.recorded, self.recorded_values, self.is_full = [], 0, False

    def keep(self, face):
        """Records a face if there is space left."""
        if self.is_full:
            return
        self.recorded_values += 1 + len(face.values) + len(face.turns)
        if self.recorded_values > RECORDED_VALUES_MAX:
            self.is_full = True
            print("marotte: the recording is full. The faces until now are kept; End Recording makes actions from them")
        else:
            self.recorded.append(face)

    def stop_recording(self, scene):
        """Makes actions with a key for each face, at the time of its performance. Times are not rounded to frames."""
        faces, self.recorded = self.recorded or [], None
        if not faces:
            raise Refused("no faces were received during the recording")
        frames = [scene.frame_current + (f.time - faces[0].time) * frames_a_second(scene) for f in faces]
        made = []
        for head in self.heads:
            keys = head.data.shape_keys
            action = bpy.data.actions.new(f"live {head.name}")
            curves, slot = curves_of(action, "KEY", keys.name)
            values = [self.keys_of(head, f) for f in faces]
            for name in sorted({n for v in values for n in v}):
                at = [(t, v[name]) for t, v in zip(frames, values) if name in v]
                put_curve(curves, value_path(name), 0, [t for t, _ in at], [v for _, v in at])
            play(keys, action, slot)
            made.append(action)
        for rig in self.rigs:
            turned = {n: b for n, b in bones_of(rig).items() if any(n in f.turns for f in faces)}
            if not turned:
                continue
            action = bpy.data.actions.new(f"live {rig.name}")
            curves, slot = curves_of(action, "OBJECT", rig.name)
            for name, bone in turned.items():
                at, before = [], None
                for t, f in zip(frames, faces):
                    if name in f.turns:
                        q = turn_of_bone(bone.bone, f.turns[name])
                        if before is not None and q.dot(before) < 0.0:
                            q.negate()  # the same rotation, nearer to the previous key
                        before = q
                        at.append((t, q))
                path = f'pose.bones["{bpy.utils.escape_identifier(bone.name)}"].rotation_quaternion'
                for k in range(4):
                    put_curve(curves, path, k, [t for t, _ in at], [q[k] for _, q in at])
            play(rig, action, slot)
            made.append(action)
        return made, len(faces)


# ---- operators and the panel ----

live = None
# Files that the user opened or updated since Blender started, each with its last time stamp. A path in a .blend is only
# data: such a file is not read automatically.
followed = {}


def selected_heads(context):
    return [o for o in context.selected_objects if o.type == "MESH"]


class Operator(bpy.types.Operator):
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        try:
            self.report({"INFO"}, self.run(context))
            return {"FINISHED"}
        except Refused as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}


class MAROTTE_OT_open_take(Operator, ImportHelper):
    """Play an exported take on the selected meshes"""
    bl_idname, bl_label = "marotte.open_take", "Open Take"
    filename_ext = ".glb"
    filter_glob: StringProperty(default="*.glb;*.vrm", options={"HIDDEN"})
    how: EnumProperty(name="As", items=[("STRIP", "NLA strip", "A strip among others, updated in place"),
                                        ("ACTION", "Action", "The animation of the mesh itself")], default="STRIP")
    adds: BoolProperty(name="Add missing shapes", default=True,
                       description="Add missing shape keys, if the mesh is that of the export")

    def run(self, context):
        return open_take(context, self.filepath, selected_heads(context), self.how, None, self.adds)


class MAROTTE_OT_update(Operator):
    """Update takes that were edited and exported again"""
    bl_idname, bl_label = "marotte.update", "Update Takes"

    def run(self, context):
        updated, news = update_takes(context)
        if news and not updated:
            raise Refused("; ".join(news))
        return "; ".join([f"{updated} updated" if updated else "all are up to date"] + news)


class MAROTTE_OT_live(Operator):
    """Start or stop showing received faces on the selected meshes and rigs"""
    bl_idname, bl_label = "marotte.live", "Live"

    def run(self, context):
        global live
        if live:
            live.close()
            live = None
            return "live faces stopped"
        scene = context.scene
        live = Live(scene.marotte_host, scene.marotte_port, context.selected_objects)
        if not bpy.app.timers.is_registered(tick_live):
            bpy.app.timers.register(tick_live)
        return "listening at %s:%d" % live.address


class MAROTTE_OT_record(Operator):
    """Record the live face, beginning at the current frame, or end the recording and make actions"""
    bl_idname, bl_label = "marotte.record", "Record"

    def run(self, context):
        if not live:
            raise Refused("press Live first")
        if live.recorded is None:
            live.record()
            return "recording"
        made, count = live.stop_recording(context.scene)
        return f"{count} faces in {len(made)} actions"


def tick_live():
    if not live:
        return None
    begun_s = time.monotonic()
    live.poll()
    return max(1.0 / 120.0, time.monotonic() - begun_s)  # leaves half of the time to the window


def tick_follow():
    """Updates takes whose file has changed."""
    scene = bpy.context.scene
    if not scene or not scene.marotte_follow:
        return 2.0
    changed = set()
    for path in {a.get(FILE) for a in bpy.data.actions if isinstance(a.get(FILE), str)} & set(followed):
        try:
            stamp = os.stat(path).st_mtime_ns
        except OSError:
            continue
        if followed[path] != stamp:
            changed.add(path)
        followed[path] = stamp
    if changed:
        update_takes(bpy.context, changed)
    return 2.0


class MAROTTE_PT_panel(bpy.types.Panel):
    bl_label, bl_category = "marotte", "marotte"
    bl_space_type, bl_region_type = "VIEW_3D", "UI"

    def draw(self, context):
        scene, column = context.scene, self.layout.column()
        column.operator("marotte.open_take", icon="IMPORT")
        column.operator("marotte.update", icon="FILE_REFRESH")
        column.prop(scene, "marotte_follow")
        column.separator()
        row = column.row(align=True)
        row.enabled = live is None
        row.prop(scene, "marotte_host", text="")
        row.prop(scene, "marotte_port", text="")
        column.operator("marotte.live", text="End Live" if live else "Live", icon="PLAY", depress=live is not None)
        if live:
            is_recording = live.recorded is not None
            column.operator("marotte.record", text="End Recording" if is_recording else "Record", icon="REC",
                            depress=is_recording)
            column.label(text=f"{live.receiver.packets} packets, {live.receiver.ignored} ignored")
            if is_recording and live.is_full:
                column.label(text="The recording is full", icon="ERROR")


classes = (MAROTTE_OT_open_take, MAROTTE_OT_update, MAROTTE_OT_live, MAROTTE_OT_record, MAROTTE_PT_panel)


def register():
    for one in classes:
        bpy.utils.register_class(one)
    scene = bpy.types.Scene
    scene.marotte_host = StringProperty(name="Listen at", default="127.0.0.1",
                                        description="127.0.0.1: only this computer; 0.0.0.0: the network")
    scene.marotte_port = IntProperty(name="Port", default=39539, min=1, max=65535)
    scene.marotte_follow = BoolProperty(name="Update automatically", default=True,
                                        description="Update a take when its file changes")
    bpy.app.timers.register(tick_follow, first_interval=2.0, persistent=True)


def unregister():
    global live
    if live:
        live.close()
        live = None
    if bpy.app.timers.is_registered(tick_follow):
        bpy.app.timers.unregister(tick_follow)
    for one in reversed(classes):
        bpy.utils.unregister_class(one)
    for name in ("marotte_host", "marotte_port", "marotte_follow"):
        delattr(bpy.types.Scene, name)


if __name__ == "__main__":
    register()
