#!/usr/bin/env python3
"""Blender's Cycles on a CPU as a peer of `python3 -m ptbench peers`, for a Python that has the package bpy.

`cycles_peer.py` builds the scene from Mitsuba's XML, as `ptbench export` writes it: cubes, rectangles and PLY meshes,
diffuse or emitting, seen by a pinhole camera. It refuses all other scenes. A render's milliseconds are the wall time of
bpy.ops.render.render: Cycles keeps its tree between renders, but updates the scene each time. Exit code 4: bpy cannot
be imported.
"""

import contextlib
import json
import os
import sys
import tempfile
import time
import xml.etree.ElementTree as ET
from pathlib import Path

MISSING = 4
_NEEDS = "cycles_peer.py: needs the package bpy: python3.11 -m pip install bpy==4.5.15"
_FACES_OF_A_CUBE = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


class Refused(Exception):
    """Raised for scene content that has no counterpart in this peer."""


class Scene:
    """The scene in Mitsuba's XML, parsed without bpy."""

    def __init__(self, path):
        self.folder = Path(path).parent
        self.root = ET.parse(path).getroot()
        self.defaults = {one.get("name"): one.get("value") for one in self.root.iter("default")}
        integrator = self.root.find("integrator")
        if integrator is None or integrator.get("type") != "path":
            raise Refused("the scene has media, which this peer lacks")
        self.depth = int(self.text(integrator.find("integer[@name='max_depth']")))
        if self.root.find("emitter") is not None:
            raise Refused("the scene has an environment, which this peer lacks")
        self.sensor = self.root.find("sensor")
        if self.sensor.get("type") != "perspective":
            raise Refused(f"a camera is a {self.sensor.get('type')}, allowed: perspective")
        self.colours = {bsdf.get("id"): self._colour(bsdf) for bsdf in self.root.findall("bsdf")}

    def text(self, element):
        """The value of an XML element, with references to the scene's defaults resolved."""
        value = element.get("value")
        return self.defaults[value[1:]] if value.startswith("$") else value

    def triple(self, element):
        """Three numbers of an XML element; a single number is repeated."""
        numbers = [float(word) for word in self.text(element).replace(",", " ").split()]
        return numbers * 3 if len(numbers) == 1 else numbers

    def matrix(self, shape):
        """The rows of a shape's to_world matrix."""
        found = shape.find("transform[@name='to_world']/matrix")
        numbers = [1.0 if i % 5 == 0 else 0.0 for i in range(16)]
        numbers = numbers if found is None else [float(word) for word in self.text(found).split()]
        return [numbers[i : i + 4] for i in range(0, 16, 4)]

    def radiance(self, shape):
        """The radiance that a shape emits; None if it emits nothing."""
        found = shape.find("emitter[@type='area']/rgb[@name='radiance']")
        return None if found is None else self.triple(found)

    def _colour(self, bsdf):
        inner = bsdf.find("bsdf") if bsdf.get("type") == "twosided" else bsdf
        if inner.get("type") == "null":
            return [0.0, 0.0, 0.0]
        reflectance = inner.find("rgb[@name='reflectance']")
        if inner.get("type") != "diffuse" or reflectance is None:
            raise Refused(f"a material is a {inner.get('type')}, allowed: diffuse of one colour")
        return self.triple(reflectance)


class Renderer:
    """Cycles, with the scene that was loaded last."""

    def __init__(self, bpy):
        self.bpy = bpy

    def about(self, _):
        """Cycles' version and number of threads, for the result file."""
        return {"version": self.bpy.app.version_string, "threads": os.cpu_count()}

    def load(self, request):
        """Builds the requested scene from scratch."""
        begun = time.perf_counter()
        if request["xml"] is None:
            raise Refused("there is no such scene in Mitsuba's XML")
        scene = Scene(request["xml"])
        self.bpy.ops.wm.read_factory_settings(use_empty=True)
        self._settings(scene, request)
        self._camera(scene)
        for shape in scene.root.findall("shape"):
            self._add(scene, shape)
        return {"load_ms": 1e3 * (time.perf_counter() - begun)}

    def image(self, request):
        """Renders a seed's picture to the requested PFM file."""
        import numpy as np

        with tempfile.TemporaryDirectory(prefix="cycles-peer-") as folder:
            self.bpy.context.scene.render.filepath = str(Path(folder) / "picture.exr")
            said = self._rendered(request, writes=True)
            image = self.bpy.data.images.load(self.bpy.context.scene.render.filepath)
            image.colorspace_settings.name = "Non-Color"
            width, height = image.size
            pixels = np.array(image.pixels[:], dtype="<f4").reshape(height, width, 4)[:, :, :3]
            self.bpy.data.images.remove(image)
        with open(request["file"], "wb") as file:
            file.write(f"PF\n{width} {height}\n-1.0\n".encode())
            file.write(np.ascontiguousarray(pixels).tobytes())
        return said

    def times(self, request):
        """Render times, after a warm-up render that is not counted."""
        return {"renders": [self._rendered(request) for _ in range(request["repetitions"] + 1)][1:]}

    def _settings(self, scene, request):
        target = self.bpy.context.scene
        target.render.engine = "CYCLES"
        target.render.resolution_x, target.render.resolution_y = request["resolution"]
        target.render.resolution_percentage = 100
        target.render.use_persistent_data = True
        target.render.image_settings.file_format = "OPEN_EXR"
        target.render.image_settings.color_depth = "32"
        cycles = target.cycles
        cycles.device = "CPU"
        # Cycles' bounces exclude the camera ray and the last ray, which ends at a light.
        bounces = max(0, (scene.depth if request["depth"] is None else request["depth"]) - 2)
        for name in ("max_bounces", "diffuse_bounces", "glossy_bounces", "transmission_bounces"):
            setattr(cycles, name, bounces)
        cycles.use_adaptive_sampling = cycles.use_denoising = cycles.use_auto_tile = False
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.light_sampling_threshold = 0
        cycles.blur_glossy = 0
        cycles.pixel_filter_type, cycles.filter_width = "BOX", 1.0

    def _camera(self, scene):
        from mathutils import Vector

        lookat = scene.sensor.find("transform[@name='to_world']/lookat")
        origin, target, up = (
            Vector([float(word) for word in lookat.get(name).replace(",", " ").split()])
            for name in ("origin", "target", "up")
        )
        back = (origin - target).normalized()
        right = up.cross(back).normalized()
        camera = self.bpy.data.cameras.new("camera")
        placed = self.bpy.data.objects.new("camera", camera)
        self.bpy.context.scene.collection.objects.link(placed)
        placed.matrix_world = _matrix(zip(right, back.cross(right), back, origin, strict=True))
        camera.sensor_fit = "VERTICAL"
        radians = 0.017453292519943295
        camera.angle = radians * float(scene.text(scene.sensor.find("float[@name='fov']")))
        camera.clip_start = float(scene.text(scene.sensor.find("float[@name='near_clip']")))
        camera.clip_end = float(scene.text(scene.sensor.find("float[@name='far_clip']")))
        self.bpy.context.scene.camera = placed

    def _add(self, scene, shape):
        kind = shape.get("type")
        if kind == "ply":
            file = scene.folder / scene.text(shape.find("string[@name='filename']"))
            self.bpy.ops.wm.ply_import(filepath=str(file), forward_axis="Y", up_axis="Z")
            mesh = self.bpy.context.object.data
            self.bpy.data.objects.remove(self.bpy.context.object)
        elif kind in ("cube", "rectangle"):
            mesh = self.bpy.data.meshes.new(kind)
            mesh.from_pydata(*_corners_and_faces(kind))
        else:
            raise Refused(f"a shape is a {kind}, allowed: cube, rectangle, ply")
        for polygon in mesh.polygons:
            polygon.use_smooth = False
        mesh.materials.clear()
        mesh.materials.append(self._material(scene.colours[shape.find("ref").get("id")], scene.radiance(shape)))
        placed = self.bpy.data.objects.new(kind, mesh)
        placed.matrix_world = _matrix(scene.matrix(shape))
        self.bpy.context.scene.collection.objects.link(placed)

    def _material(self, colour, radiance):
        material = self.bpy.data.materials.new("material")
        material.use_nodes = True
        tree = material.node_tree
        tree.nodes.clear()
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        if radiance is None:
            node = tree.nodes.new("ShaderNodeBsdfDiffuse")
            node.inputs["Color"].default_value = (*colour, 1)
        elif any(colour):
            raise Refused("a material both emits and reflects")
        else:
            node = tree.nodes.new("ShaderNodeEmission")
            strength = max(radiance)
            node.inputs["Color"].default_value = (*(one / strength for one in radiance), 1)
            node.inputs["Strength"].default_value = strength
        tree.links.new(node.outputs[0], output.inputs["Surface"])
        return material

    def _rendered(self, request, writes=False):
        cycles = self.bpy.context.scene.cycles
        cycles.samples, cycles.seed = request["spp"], request["seed"] % 2**31
        begun = time.perf_counter()
        with _nothing_printed():
            self.bpy.ops.render.render(write_still=writes)
        wall_ms = 1e3 * (time.perf_counter() - begun)
        return {"ms": wall_ms, "wall_ms": wall_ms, "compile_ms": 0.0}


def _matrix(rows):
    from mathutils import Matrix

    rows = [list(row) for row in rows]
    return Matrix(rows if len(rows) == 4 else [*rows, [0, 0, 0, 1]])


def _corners_and_faces(kind):
    if kind == "rectangle":
        return [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)]
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    return corners, [], _FACES_OF_A_CUBE


@contextlib.contextmanager
def _nothing_printed():
    """A context that discards what Blender prints to standard output, which carries the answers."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def main():
    """Answers requests from standard input until it ends."""
    try:
        with _nothing_printed():
            import bpy
    except ImportError as error:
        print(f"{_NEEDS} ({error})", file=sys.stderr)
        return MISSING
    renderer = Renderer(bpy)
    for line in sys.stdin:
        try:
            request = json.loads(line)
            with _nothing_printed():
                said = getattr(renderer, request["do"])(request)
        except (Refused, OSError, RuntimeError, ValueError, ET.ParseError) as error:
            said = {"error": str(error)}
        print(json.dumps(said), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
