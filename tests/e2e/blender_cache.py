# What is shown in Blender, against the vertices of a point cache of marotte: for the scripts that run in it.
import json
import struct
import sys

import bpy
import numpy

if "bool" not in vars(numpy):  # Debian 12's Blender asks its NumPy for names that it no longer has
    numpy.bool = bool


def meshes_with_shapes():
    return [o for o in bpy.context.scene.objects if o.type == "MESH" and o.data.shape_keys]


def shown(meshes):
    """Of each mesh where its vertices are, mm, in the file's axes; skins and all."""
    graph = bpy.context.evaluated_depsgraph_get()
    for thing in meshes:
        matrix = thing.matrix_world
        mesh = thing.evaluated_get(graph).to_mesh()
        places = [matrix @ v.co for v in mesh.vertices]
        yield thing, [(1000 * x, 1000 * z, -1000 * y) for x, y, z in places]


class Cache:
    """bare: the mesh alone as .glb: where the vertices of the cache are at rest, and so which are which."""

    def __init__(self, bare, pc2):
        with open(bare, "rb") as file:
            data = file.read()
        length = struct.unpack_from("<I", data, 12)[0]
        gltf = json.loads(data[20:20 + length])
        position = gltf["accessors"][gltf["meshes"][0]["primitives"][0]["attributes"]["POSITION"]]
        view = gltf["bufferViews"][position["bufferView"]]
        start = 20 + length + 8 + view.get("byteOffset", 0) + position.get("byteOffset", 0)
        self.rest = [struct.unpack_from("<3f", data, start + 12 * i) for i in range(position["count"])]
        self.load(pc2)

    def load(self, pc2):
        """Another cache of the same vertices."""
        with open(pc2, "rb") as file:
            head = struct.unpack("<12siiffi", file.read(32))
            self.vertices, self.frames = head[2], head[5]
            self.data = file.read()
        if self.vertices != len(self.rest):
            sys.exit(f"the cache has {self.vertices} vertices, the file {len(self.rest)}")

    def find(self, meshes):
        """Which vertices are which, now that the meshes are at rest. Returns how many were found."""
        cell = 1e-5 * max(abs(c) for r in self.rest for c in r)
        places = {}
        for i, r in enumerate(self.rest):
            places.setdefault(tuple(round(c / cell) for c in r), []).append(i)
        near = [(a, b, c) for a in (-1, 0, 1) for b in (-1, 0, 1) for c in (-1, 0, 1)]
        at_rest = list(shown(meshes))
        for self.turn in (1, -1):  # a file that faces -z, as VRM 0, has half a turn about y
            self.pairs = []  # an imported vertex and those of the cache that are at its place
            for thing, at in at_rest:
                for index, (x, y, z) in enumerate(at):
                    middle = [round(0.001 * c / cell) for c in (self.turn * x, y, self.turn * z)]
                    found = [i for n in near for i in places.get(tuple(m + d for m, d in zip(middle, n)), [])]
                    if found:
                        self.pairs.append((thing, index, found))
            if self.pairs:
                break
        return len(self.pairs)

    def off(self, scene_frame):
        """How far what is shown is off at ten times of the cache at most, mm, and how far the face moves. scene_frame:
        of a frame of the cache."""
        worst = furthest = 0.0
        for n in range(10):
            frame = (self.frames - 1) * n // 9
            bpy.context.scene.frame_set(scene_frame(frame))
            now = dict(shown({thing for thing, _, _ in self.pairs}))
            for thing, index, found in self.pairs:
                x, y, z = now[thing][index]
                here = (self.turn * x, y, self.turn * z)
                off = 1e9
                for i in found:
                    there = struct.unpack_from("<3f", self.data, (frame * self.vertices + i) * 12)
                    off = min(off, sum((a - b) ** 2 for a, b in zip(here, there)) ** 0.5)
                    moved = sum((1000 * a - b) ** 2 for a, b in zip(self.rest[i], there)) ** 0.5
                    furthest = max(furthest, moved)
                worst = max(worst, off)
        return worst, furthest


def still(meshes):
    """No action plays, no key is on."""
    for thing in meshes:
        keys = thing.data.shape_keys
        if keys.animation_data:
            keys.animation_data.action = None
            for track in keys.animation_data.nla_tracks:
                track.mute = True
        for key in keys.key_blocks:
            key.value = 0
