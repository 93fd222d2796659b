"""Generators of map scenes: a rule and its parameters make one scene file."""

import math
from collections.abc import Callable, Mapping

_WHITE = {"type": "diffuse", "albedo": [0.98, 0.98, 0.98]}
_INSIDE = {"eye": [0, 5, 10.5], "look_at": [0, 5, 0], "up": [0, 1, 0], "vertical_fov_degrees": 90}


def _scene(name: str, camera: Mapping, materials: Mapping, objects: list) -> dict:
    # A generated scene file's resolution and depth are only defaults, which each cell of a map overrides.
    return {
        "name": name, "max_depth": 8, "camera": {**camera, "resolution": [800, 800]},
        "materials": dict(materials), "objects": objects,
    }  # fmt: skip


def _box(material: str, translate: list[float], scale: list[float]) -> dict:
    return {"shape": "box", "material": material, "translate": translate, "scale": scale}


def balls(materials: float) -> dict:
    """The closed box of scenes/scaling with 64 equal balls, divided among `materials` equal materials."""
    count = int(materials)
    names = {f"ball_{index:02}": {"type": "diffuse", "albedo": [0.7, 0.7, 0.7]} for index in range(count)}
    places = [
        [-3.75 + 2.5 * (index % 4), [1.25, 3.5, 5.75, 8.0][index // 4 % 4], -3.75 + 2.0 * (index // 16)]
        for index in range(64)
    ]
    spheres = [
        {"shape": "sphere", "material": f"ball_{index % count:02}", "translate": place, "scale": 1.5}
        for index, place in enumerate(places)
    ]
    lamp = {"light": {"type": "emitter", "radiance": [5, 5, 5]}, "white": _WHITE}
    return _scene(f"balls_{count}", _INSIDE, {**lamp, **names}, [*_room(15.0), *spheres])


def _room(front: float) -> list[dict]:
    """The Cornell box with its lamp, from its back wall to a wall at z = `front`."""
    middle, length = (front - 5) / 2, front + 5
    return [
        _box("light", [0, 10, 0], [3, 0.3, 3]),
        _box("white", [0, 0, middle], [10, 0.01, length]),
        _box("white", [0, 10, middle], [10, 0.01, length]),
        _box("white", [0, 5, -5], [10, 10, 0.01]),
        _box("white", [-5, 5, middle], [0.01, 10, length]),
        _box("white", [5, 5, middle], [0.01, 10, length]),
        _box("white", [0, 5, front], [10, 10, 0.01]),
    ]


def openness(openness: float) -> dict:
    """A room around the camera whose front half is closed except for a fraction `openness` of each wall's extent."""
    rest = 1 - openness
    walls = [one for one in _room(5.0) if one["translate"] != [0, 5, 5.0]]
    if rest > 0:
        walls += [
            _box("white", [0, 0, 10], [10 * rest, 0.01, 10]),
            _box("white", [0, 10, 10], [10 * rest, 0.01, 10]),
            _box("white", [-5, 5, 10], [0.01, 10 * rest, 10]),
            _box("white", [5, 5, 10], [0.01, 10 * rest, 10]),
            _box("white", [0, 5, 15], [10 * rest, 10 * rest, 0.01]),
        ]
    ball = {"shape": "sphere", "material": "mirror", "translate": [-1, 4, -1], "scale": 3}
    materials = {"light": {"type": "emitter", "radiance": [5, 5, 5]}, "white": _WHITE,
                 "mirror": {"type": "mirror", "reflectance": [0.98, 0.98, 0.98]}}  # fmt: skip
    return _scene(f"open_{openness:g}".replace(".", "_"), _INSIDE, materials, [*walls, ball])


def trefoil(triangles: float) -> dict:
    """The open room of scenes/meshes with a knot of about `triangles` triangles (16 N^2)."""
    size = max(3, round(math.sqrt(triangles / 16)))
    materials = {"light": {"type": "emitter", "radiance": [8, 8, 8]},
                 "white": {"type": "diffuse", "albedo": [0.9, 0.9, 0.9]}}  # fmt: skip
    camera = {"eye": [0, 5, 14], "look_at": [0, 4.5, 0], "up": [0, 1, 0], "vertical_fov_degrees": 45}
    walls = [one for one in _room(5.0) if one["translate"] != [0, 5, 5.0]]
    mesh = {"shape": "mesh", "generate": {"mesh": "trefoil", "size": size}, "material": "white",
            "translate": [0, 4.5, 0], "scale": 3}  # fmt: skip
    return _scene(f"trefoil_{size}", camera, materials, [*walls, mesh])


def lamps(lamps: float, size: float) -> dict:
    """The open Cornell box with square lamps of side `size` under its ceiling, with constant total power."""
    count, side = int(lamps), math.ceil(math.sqrt(lamps))
    radiance = [45 / (count * size * size)] * 3
    pitch = 9.0 / side
    middle = (side - 1) / 2
    under = [
        _box("light", [pitch * (index % side - middle), 9.9, pitch * (index // side - middle)], [size, 0.05, size])
        for index in range(count)
    ]
    materials = {"light": {"type": "emitter", "radiance": radiance},
                 "white": {"type": "diffuse", "albedo": [0.8, 0.8, 0.8]}}  # fmt: skip
    walls = [one for one in _room(5.0) if one["translate"] not in ([0, 5, 5.0], [0, 10, 0])]
    walls += [_box("white", [0, 10, 0], [10, 0.01, 10]),
              _box("white", [-2, 1.75, -2], [2.5, 3.5, 2.5]),
              {"shape": "sphere", "material": "white", "translate": [2, 1.6, -0.5], "scale": 3}]  # fmt: skip
    name = f"lamps_{count}_{size:g}".replace(".", "_")
    return _scene(name, _INSIDE, materials, [*under, *walls])


RULES: dict[str, Callable[..., dict]] = {"balls": balls, "openness": openness, "trefoil": trefoil, "lamps": lamps}
