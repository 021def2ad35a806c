"""How the nodes of “Print Layers” work out the relief: `engines.glass.relief.relieve`, drawn."""

import functools
import math
from collections.abc import Callable
from typing import Any

import bpy

from ...engines.glass.relief import CREASE, OPPOSITE, SHIFTS
from ...engines.glass.skin import OUTWARD, STEEP

NORMAL, SIDE, TURN = (f"heliform_{name}" for name in ("normal", "side", "turn"))
"""What a wall's vertices carry of its `Skin`. The turn is a place on a circle of the wall's girth,
so that what subdivides the mesh finds the middle across the seam too."""

VALUES = "heliform_values"
"""What a style's points carry: a header, both profiles and the texture, one after another."""

SAMPLES, OUTER, INNER, WIDE, HIGH, TEXTURE, LONG, TALL = range(8)
"""Where the header tells: how many samples a profile has, where the two start, how many columns and
rows the texture has, where it starts, how long and tall it is. 0 where there is none."""

HEADER = 8

INPUTS = {
    "height": "Layer Height",
    "amplitude": "Amplitude",
    "crest": "Crest",
    "spiral": "Spiral",
    "base": "Base",
    "roughness": "Roughness",
    "seed": "Seed",
    "sides": "Sides",
}
"""The inputs of the modifier that hold a field of `Relief`."""

STYLE, MASK = "Style", "Mask"

Out = Any  # a socket, or a number in its place
Reader = Callable[[Out], Out]


def word_of(choice: str) -> str:
    """A choice of `Relief` as the menu says it."""
    return choice.capitalize()


class _Nodes:
    """Draws nodes from left to right, each a column beyond those that it takes from."""

    def __init__(self, tree: bpy.types.NodeTree) -> None:
        self.tree = tree
        self.filled: dict[int, int] = {}
        self.column: dict[str, int] = {}
        self.given = self.add("NodeGroupInput").outputs

    def add(self, kind: str, inputs: dict[str, Out] | None = None, **settings: Any) -> Any:
        """A node with ``settings``, its inputs (by identifier) linked or set."""
        node = self.tree.nodes.new(kind)
        for key, value in settings.items():
            setattr(node, key, value)
        column = 0
        for key, value in (inputs or {}).items():
            socket = next(s for s in node.inputs if key in (s.identifier, s.name))
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
                column = max(column, self.column[value.node.name] + 1)
            else:
                socket.default_value = value
        row = self.filled.get(column, 0)
        self.filled[column] = row + 1
        self.column[node.name] = column
        node.location = (column * 180, -row * 180)
        node.hide = kind == "ShaderNodeMath"
        return node

    def math(self, operation: str, *values: Out) -> Out:
        """One step of arithmetic."""
        keys = ("Value", "Value_001", "Value_002")
        inputs: dict[str, Out] = dict(zip(keys, values, strict=False))
        return self.add("ShaderNodeMath", inputs, operation=operation).outputs[0]

    def named(self, name: str, kind: str = "FLOAT") -> Any:
        """An attribute of the mesh, and whether it is there."""
        return self.add("GeometryNodeInputNamedAttribute", {"Name": name}, data_type=kind).outputs

    def sample(self, geometry: Out, value: Out, index: Out, kind: str = "FLOAT") -> Out:
        """The value of one point."""
        inputs = {"Geometry": geometry, "Value": value, "Index": index}
        return self.add("GeometryNodeSampleIndex", inputs, data_type=kind).outputs[0]

    def either(self, kind: str, which: Out, no: Out, yes: Out) -> Out:
        """One of two; where ``which`` is a single value, the other is not worked out."""
        inputs = {"Switch": which, "False": no, "True": yes}
        return self.add("GeometryNodeSwitch", inputs, input_type=kind).outputs[0]

    def split(self, vector: Out) -> Any:
        """The components of a vector."""
        return self.add("ShaderNodeSeparateXYZ", {"Vector": vector}).outputs

    def scaled(self, vector: Out, factor: Out) -> Out:
        """A vector times a number."""
        inputs = {"Vector": vector, "Scale": factor}
        return self.add("ShaderNodeVectorMath", inputs, operation="SCALE").outputs[0]

    def mix(self, share: Out, start: Out, end: Out) -> Out:
        """From ``start`` to ``end``."""
        inputs = {"Factor_Float": share, "A_Float": start, "B_Float": end}
        return self.add("ShaderNodeMix", inputs, clamp_factor=False).outputs[0]

    def menu(self, which: Out, words: list[str]) -> list[Out]:
        """Whether each word is the chosen one."""
        node = self.add("GeometryNodeMenuSwitch", data_type="FLOAT")
        node.enum_items.clear()
        for word in words:
            node.enum_items.new(word)
        self.tree.links.new(which, node.inputs["Menu"])
        return [node.outputs[word] for word in words]


def connect(tree: bpy.types.NodeTree) -> None:
    """Draw the nodes from the mesh that comes in to the mesh with relief."""
    n = _Nodes(tree)
    given = n.given
    mesh = given["Geometry"]
    normal, side, turn, girth = _skin(n, mesh)
    read = _reader(n, given[STYLE])
    inner = n.math("LESS_THAN", side, 0.0)
    _, _, z = n.split(n.add("GeometryNodeInputPosition").outputs[0])
    z = n.math("SUBTRACT", z, given[INPUTS["base"]])

    stands = _profile(n, read, z, turn, inner)
    depth = n.math("MULTIPLY", given[INPUTS["amplitude"]], n.math("MINIMUM", read(SAMPLES), 1.0))
    sunk = n.math("MULTIPLY", depth, n.math("MULTIPLY", given[INPUTS["crest"]], -1.0))
    offset = n.math("MULTIPLY_ADD", stands, depth, sunk)
    rough = given[INPUTS["roughness"]]
    bumps = n.math("MULTIPLY_ADD", _texture(n, read, z, turn, inner, girth), rough, offset)
    is_rough = n.math("MULTIPLY", rough, read(WIDE))
    offset = n.either("FLOAT", n.math("GREATER_THAN", is_rough, 0.0), offset, bumps)

    sides = given[INPUTS["sides"]]
    only_outer, only_inner, _ = n.menu(
        sides, [word_of(word) for word in ("outer", "inner", "both")]
    )
    more_inside = n.math("SUBTRACT", only_inner, only_outer)
    on_outer = n.math("SUBTRACT", 1.0, only_inner)
    weight = n.math("MULTIPLY", side, n.math("MULTIPLY_ADD", inner, more_inside, on_outer))
    offset = n.math("MULTIPLY", offset, n.math("MULTIPLY", weight, given[MASK]))
    inputs = {"Geometry": mesh, "Offset": n.scaled(normal, offset)}
    moved = n.add("GeometryNodeSetPosition", inputs)
    n.add("NodeGroupOutput", {"Geometry": _shaded(n, moved.outputs[0])})


def _skin(n: _Nodes, mesh: Out) -> tuple[Out, Out, Out, Out]:
    """Normal, side, turn and girth: the wall's own where it brings them, else as `skin_of`."""
    place = n.add("GeometryNodeInputPosition").outputs[0]
    normal, side = _skin_of(n, place)
    own, exists = n.named(NORMAL, "FLOAT_VECTOR")
    has = n.sample(mesh, exists, 0, "BOOLEAN")
    x, y, _ = n.split(n.either("VECTOR", has, place, n.named(TURN, "FLOAT_VECTOR")[0]))
    turn = n.math("FRACT", n.math("MULTIPLY", n.math("ARCTAN2", y, x), 1 / (2 * math.pi)))
    inputs = {"Geometry": mesh, "Attribute": _length(n, x, y)}
    radius = n.add("GeometryNodeAttributeStatistic", inputs).outputs["Mean"]
    return (
        n.either("VECTOR", has, normal, own),
        n.either("FLOAT", has, side, n.named(SIDE)[0]),
        turn,
        n.math("MULTIPLY", radius, 2 * math.pi),
    )


def _skin_of(n: _Nodes, place: Out) -> tuple[Out, Out]:
    """Normal and side from the mesh itself, about its own Z axis."""
    x, y, _ = n.split(place)
    along, across, _ = n.split(n.add("GeometryNodeInputNormal").outputs["True Normal"])
    level = _length(n, along, across)
    out = n.math("MULTIPLY_ADD", along, x, n.math("MULTIPLY", across, y))
    looks_in = n.math("LESS_THAN", n.math("DIVIDE", out, _length(n, x, y)), OUTWARD)
    facing = n.math("MULTIPLY_ADD", looks_in, -2.0, 1.0)
    flat = n.add("ShaderNodeCombineXYZ", {"X": along, "Y": across}).outputs[0]
    normal = n.scaled(flat, n.math("DIVIDE", facing, level))
    fading = n.math("MINIMUM", n.math("MULTIPLY", level, STEEP), 1.0)
    return normal, n.math("MULTIPLY", facing, fading)


def _length(n: _Nodes, x: Out, y: Out) -> Out:
    return n.math("SQRT", n.math("MULTIPLY_ADD", x, x, n.math("MULTIPLY", y, y)))


def _reader(n: _Nodes, style: Out) -> Callable[[Out], Out]:
    """What reads the style: a figure of its header, or a sample that each vertex asks for."""
    inputs = {"Object": style, "As Instance": False}
    points = n.add("GeometryNodeObjectInfo", inputs, transform_space="ORIGINAL").outputs["Geometry"]
    values = n.named(VALUES)[0]
    return functools.cache(lambda index: n.sample(points, values, index))


def _profile(n: _Nodes, read: Reader, z: Out, turn: Out, inner: Out) -> Out:
    """How far the relief stands out, 0 to 1, by the phase in the layer."""
    up = n.math("DIVIDE", z, n.given[INPUTS["height"]])
    wound = n.math("MULTIPLY", n.given[INPUTS["spiral"]], -1.0)
    phase = n.math("FRACT", n.math("MULTIPLY_ADD", turn, wound, up))
    place = n.math("MULTIPLY", phase, read(SAMPLES))
    cell = n.math("FLOOR", place)
    further = n.math("SUBTRACT", read(INNER), read(OUTER))
    start = n.math("MULTIPLY_ADD", inner, further, read(OUTER))
    index = n.math("ADD", cell, start)
    ahead = n.math("ADD", index, 1.0)
    return n.mix(n.math("SUBTRACT", place, cell), read(index), read(ahead))


def _texture(n: _Nodes, read: Reader, z: Out, turn: Out, inner: Out, girth: Out) -> Out:
    """The texture's height, for a roughness of 1."""
    seed = n.given[INPUTS["seed"]]
    along, up = (n.math("FRACT", n.math("MULTIPLY", seed, float(shift))) for shift in SHIFTS)
    fitting = n.math("ADD", n.math("DIVIDE", girth, read(LONG)), 0.5)
    around = n.math("MAXIMUM", n.math("FLOOR", fitting), 1.0)
    along = n.math("MULTIPLY_ADD", inner, OPPOSITE, along)
    along = n.math("MULTIPLY_ADD", turn, around, along)
    up = n.math("ADD", n.math("DIVIDE", z, read(TALL)), up)

    wide, high = read(WIDE), read(HIGH)
    x = n.math("MULTIPLY", n.math("FRACT", along), wide)
    y = n.math("MULTIPLY", n.math("FRACT", up), high)
    column, row = n.math("FLOOR", x), n.math("FLOOR", y)
    stride = n.math("ADD", wide, 1.0)
    low = n.math("MULTIPLY_ADD", row, stride, n.math("ADD", column, read(TEXTURE)))
    above = n.math("ADD", low, stride)
    across = n.math("SUBTRACT", x, column)
    lower, upper = (
        n.mix(across, read(start), read(n.math("ADD", start, 1.0))) for start in (low, above)
    )
    return n.mix(n.math("SUBTRACT", y, row), lower, upper)


def _shaded(n: _Nodes, mesh: Out) -> Out:
    """Smooth but for creases; free normals of the smooth wall would hide the relief."""
    angle = n.add("GeometryNodeInputMeshEdgeAngle").outputs["Unsigned Angle"]
    inputs = {
        "Mesh": mesh,
        "Remove Custom": True,
        "Edge Sharpness": n.math("GREATER_THAN", angle, CREASE),
        "Face Sharpness": False,
    }
    return n.add("GeometryNodeSetMeshNormal", inputs, mode="SHARPNESS").outputs[0]
