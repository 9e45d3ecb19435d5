# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees written as expressions.

A ``Socket`` is the output of a node; arithmetic on it adds math nodes, so that the formula of a material reads
like the formula in its comment. ``Tree`` wraps one node tree; ``arrange`` lays the nodes out in columns by their
distance from the output, for artists who open the material.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, cast

import bpy

VERSION = 3  # of the node groups: raise it when a group changes
COLUMN, ROW = 190.0, 46.0  # spacing of the layout, in the node editor's pixels

Operand: TypeAlias = "Socket | float | Sequence[float]"


def srgb(hexadecimal: str) -> tuple[float, float, float, float]:
    """'#rrggbb' as the scene-linear RGBA that nodes expect."""
    channels = [int(hexadecimal[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return (linear[0], linear[1], linear[2], 1.0)


class Socket:
    """Output socket of a node, with arithmetic. The socket's type says whether it is a vector or a scalar."""

    def __init__(self, tree: Tree, socket: bpy.types.NodeSocket):
        self.tree, self.socket = tree, socket

    def _binary(self, operation: str, other: Operand, swapped: bool = False) -> Socket:
        a, b = (other, self) if swapped else (self, other)
        vector = any(isinstance(s, Socket) and s.socket.type in {"VECTOR", "RGBA"} for s in (a, b))
        return self.tree.vector(operation, a, b) if vector else self.tree.math(operation, a, b)

    def __add__(self, other: Operand) -> Socket:
        return self._binary("ADD", other)

    def __sub__(self, other: Operand) -> Socket:
        return self._binary("SUBTRACT", other)

    def __rtruediv__(self, other: Operand) -> Socket:
        return self._binary("DIVIDE", other, swapped=True)

    def __rsub__(self, other: Operand) -> Socket:
        return self._binary("SUBTRACT", other, swapped=True)

    def __mul__(self, other: Operand) -> Socket:
        return self._binary("MULTIPLY", other)

    def __truediv__(self, other: Operand) -> Socket:
        return self._binary("DIVIDE", other)

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, exponent: Operand) -> Socket:
        return self.tree.math("POWER", self, exponent)

    def scaled(self, factor: Operand) -> Socket:
        """The vector times a scalar."""
        return self.tree.vector("SCALE", self, scale=factor)

    def clamped(self) -> Socket:
        return self.tree.math("ADD", self, 0.0, clamp=True)

    def ramp(self, low: float, high: float, width: Operand | None = None) -> Socket:
        """0 below ``low``, 1 above ``high``, smooth between (also for low > high, then falling); both in units
        of ``width``."""
        if width is not None:
            return (self / width).ramp(low, high)
        node = self.tree.node("ShaderNodeMapRange", interpolation_type="SMOOTHSTEP")
        first, last = (0.0, 1.0) if low < high else (1.0, 0.0)
        node.inputs["From Min"].default_value, node.inputs["From Max"].default_value = min(low, high), max(low, high)
        node.inputs["To Min"].default_value, node.inputs["To Max"].default_value = first, last
        self.tree.connect(self, node.inputs["Value"])
        return Socket(self.tree, node.outputs["Result"])


class Tree:
    """One node tree under construction."""

    def __init__(self, tree: bpy.types.NodeTree):
        self.tree = tree

    def node(self, kind: str, **settings: object) -> bpy.types.Node:
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        return node

    def connect(self, value: Operand, socket: bpy.types.NodeSocket) -> None:
        if isinstance(value, Socket):
            self.tree.links.new(value.socket, socket)
        else:
            socket.default_value = value

    def math(self, operation: str, *operands: Operand, clamp: bool = False) -> Socket:
        node = self.node("ShaderNodeMath", operation=operation, use_clamp=clamp)
        for value, socket in zip(operands, node.inputs, strict=False):
            self.connect(value, socket)
        return Socket(self, node.outputs[0])

    def vector(self, operation: str, *operands: Operand, scale: Operand | None = None) -> Socket:
        node = self.node("ShaderNodeVectorMath", operation=operation)
        for value, socket in zip(operands, node.inputs, strict=False):
            is_scalar = isinstance(value, int | float)
            self.connect((value,) * 3 if is_scalar else value, socket)
        if scale is not None:
            self.connect(scale, node.inputs["Scale"])
        scalar_result = operation in {"LENGTH", "DISTANCE", "DOT_PRODUCT"}
        return Socket(self, node.outputs["Value" if scalar_result else "Vector"])

    def combine(self, x: Operand, y: Operand, z: Operand) -> Socket:
        node = self.node("ShaderNodeCombineXYZ")
        for value, socket in zip((x, y, z), node.inputs, strict=True):
            self.connect(value, socket)
        return Socket(self, node.outputs[0])

    def component(self, value: Socket, axis: str) -> Socket:
        node = self.node("ShaderNodeSeparateXYZ")
        self.connect(value, node.inputs[0])
        return Socket(self, node.outputs[axis])

    def components(self, value: Socket) -> list[Socket]:
        node = self.node("ShaderNodeSeparateXYZ")
        self.connect(value, node.inputs[0])
        return [Socket(self, socket) for socket in node.outputs]

    def attribute(self, name: str, output: str) -> Socket:
        """Attribute of the mesh: ``output`` is 'Vector' or 'Fac'."""
        node = self.node("ShaderNodeAttribute", attribute_type="GEOMETRY", attribute_name=name, label=name)
        return Socket(self, node.outputs[output])

    def named_attribute(self, name: str, data_type: str) -> Socket:
        """Attribute of the geometry, in Geometry Nodes."""
        node = self.node("GeometryNodeInputNamedAttribute", data_type=data_type)
        node.inputs["Name"].default_value = name
        return Socket(self, next(s for s in node.outputs if s.enabled and s.name == "Attribute"))

    def position(self) -> Socket:
        return Socket(self, self.node("GeometryNodeInputPosition").outputs[0])

    def vertex_normal(self) -> Socket:
        return Socket(self, self.node("GeometryNodeInputNormal").outputs[0])

    def corner_vertex(self, offset: int) -> Socket:
        """At corners of faces: the vertex of the corner that lies so many further along the face."""
        corner = self.node("GeometryNodeOffsetCornerInFace")
        corner.inputs["Offset"].default_value = offset
        vertex = self.node("GeometryNodeVertexOfCorner")
        self.tree.links.new(corner.outputs[0], vertex.inputs[0])
        return Socket(self, vertex.outputs[0])

    def at_vertex(self, value: Socket, vertex: Socket) -> Socket:
        """A vector of that vertex."""
        node = self.node("GeometryNodeFieldAtIndex", domain="POINT", data_type="FLOAT_VECTOR")
        self.connect(value, node.inputs["Value"])
        self.connect(vertex, node.inputs["Index"])
        return Socket(self, node.outputs[0])

    def captured(
        self, geometry: Socket, values: Sequence[Socket], domain: str = "POINT"
    ) -> tuple[Socket, list[Socket]]:
        """Values of vertices, or of another domain, worked out once for all that use them; with the geometry to go on
        with."""
        node: Any = self.node("GeometryNodeCaptureAttribute", domain=domain)
        for value in values:
            node.capture_items.new("VECTOR" if value.socket.type == "VECTOR" else "FLOAT", "Value")
        self.connect(geometry, node.inputs[0])
        for value, socket in zip(values, _numbered(node.inputs), strict=True):
            self.connect(value, socket)
        return Socket(self, node.outputs[0]), [Socket(self, socket) for socket in _numbered(node.outputs)]

    def with_attribute(self, geometry: Socket, name: str, data_type: str, value: Socket) -> Socket:
        """The geometry with an attribute of its vertices."""
        node = self.node("GeometryNodeStoreNamedAttribute", domain="POINT", data_type=data_type)
        node.inputs["Name"].default_value = name
        self.connect(geometry, node.inputs["Geometry"])
        self.connect(value, node.inputs["Value"])
        return Socket(self, node.outputs[0])

    def scene_time(self, unit: str) -> Socket:
        """The scene's time in "Seconds" or as "Frame", in Geometry Nodes."""
        return Socket(self, self.node("GeometryNodeInputSceneTime").outputs[unit])

    def without(self, geometry: Socket, domain: str, selection: Socket) -> Socket:
        """The geometry without its selected points or curves."""
        node = self.node("GeometryNodeDeleteGeometry", domain=domain)
        self.connect(geometry, node.inputs["Geometry"])
        self.connect(selection, node.inputs["Selection"])
        return Socket(self, node.outputs["Geometry"])

    def noise(
        self,
        coordinate: Socket,
        scale: Operand,
        detail: Operand = 2.0,
        roughness: Operand = 0.5,
        distortion: Operand | None = None,
    ) -> Socket:
        """fBm in [0, 1] with mean 0.5, of a vector or of one number."""
        solid = coordinate.socket.type == "VECTOR"
        node = self.node("ShaderNodeTexNoise", noise_dimensions="3D" if solid else "1D", normalize=True)
        self.connect(coordinate, node.inputs["Vector" if solid else "W"])
        for name, value in (("Scale", scale), ("Detail", detail), ("Roughness", roughness)):
            self.connect(value, node.inputs[name])
        if distortion is not None:
            self.connect(distortion, node.inputs["Distortion"])
        return Socket(self, node.outputs[0])

    def noise_color(self, coordinate: Socket, scale: Operand, detail: Operand = 0.0) -> Socket:
        """Three independent noises as one vector."""
        node = self.node("ShaderNodeTexNoise", noise_dimensions="3D", normalize=True)
        for name, value in (("Vector", coordinate), ("Scale", scale), ("Detail", detail)):
            self.connect(value, node.inputs[name])
        return Socket(self, node.outputs[1])

    def white_noise(self, place: Socket) -> Socket:
        """Three random numbers for each vector, as one colour."""
        node = self.node("ShaderNodeTexWhiteNoise", noise_dimensions="3D")
        self.connect(place, node.inputs["Vector"])
        return Socket(self, node.outputs["Color"])

    def image(self, image: bpy.types.Image, place: Socket, interpolation: str, extension: str) -> tuple[Socket, Socket]:
        """Colour and opacity of an image at UV coordinates."""
        node = self.node("ShaderNodeTexImage", image=image, interpolation=interpolation, extension=extension)
        self.connect(place, node.inputs["Vector"])
        return Socket(self, node.outputs["Color"]), Socket(self, node.outputs["Alpha"])

    def phasor(
        self, coordinate: Socket, scale: Operand, frequency: Operand, direction: Socket, weight: Operand
    ) -> tuple[Socket, Socket]:
        """Real and imaginary part of weighted phasor noise whose waves run along ``direction``."""
        node = self._gabor(coordinate, scale, frequency, direction, 1.0)
        angle = Socket(self, node.outputs["Phase"]) * math.tau
        radius = Socket(self, node.outputs["Intensity"]) * weight
        return self.math("COSINE", angle) * radius, self.math("SINE", angle) * radius

    def gabor(
        self, coordinate: Socket, scale: Operand, frequency: Operand, direction: Socket, anisotropy: Operand
    ) -> Socket:
        """Gabor noise of mean 0.5 whose waves run along ``direction``: exactly for anisotropy 1, anywhere for 0."""
        return Socket(self, self._gabor(coordinate, scale, frequency, direction, anisotropy).outputs["Value"])

    def _gabor(
        self, coordinate: Socket, scale: Operand, frequency: Operand, direction: Socket, anisotropy: Operand
    ) -> bpy.types.Node:
        node = self.node("ShaderNodeTexGabor", gabor_type="3D")
        inputs = ("Vector", "Scale", "Frequency", "Anisotropy")
        for name, value in zip(inputs, (coordinate, scale, frequency, anisotropy), strict=True):
            self.connect(value, node.inputs[name])
        self.connect(direction, next(s for s in node.inputs if s.identifier == "Orientation 3D"))
        return node

    def object_normal(self) -> Socket:
        """The smooth normal in the space of the mesh, as the fields are."""
        world = Socket(self, self.node("ShaderNodeNewGeometry").outputs["Normal"])
        transform = self.node(
            "ShaderNodeVectorTransform", vector_type="NORMAL", convert_from="WORLD", convert_to="OBJECT"
        )
        self.connect(world, transform.inputs[0])
        return Socket(self, transform.outputs[0])

    def object_coordinates(self) -> Socket:
        """The place in the space of the mesh."""
        return Socket(self, self.node("ShaderNodeTexCoord").outputs["Object"])

    def facing(self) -> Socket:
        """0 where the surface faces the viewer, 1 at its rim."""
        return Socket(self, self.node("ShaderNodeLayerWeight").outputs["Facing"])

    def mix(self, factor: Operand, a: Operand, b: Operand, blend: str = "MIX") -> Socket:
        """Colours a and b mixed by the factor."""
        node = self.node("ShaderNodeMix", data_type="RGBA", blend_type=blend, clamp_factor=True)
        of_type = {s.identifier: s for s in node.inputs}
        for value, name in ((factor, "Factor_Float"), (a, "A_Color"), (b, "B_Color")):
            self.connect(value, of_type[name])
        return Socket(self, next(s for s in node.outputs if s.identifier == "Result_Color"))

    def color_ramp(self, value: Socket, stops: Sequence[tuple[float, str]], interpolation: str = "EASE") -> Socket:
        node = self.node("ShaderNodeValToRGB")
        ramp = node.color_ramp
        ramp.interpolation = interpolation
        while len(ramp.elements) < len(stops):
            ramp.elements.new(1.0)
        for element, (position, color) in zip(ramp.elements, stops, strict=True):
            element.position, element.color = position, srgb(color)
        self.connect(value, node.inputs[0])
        return Socket(self, node.outputs["Color"])

    def group(self, group: bpy.types.NodeTree, **inputs: Operand) -> dict[str, Socket]:
        """A node group as a node; keyword 'band_scale' sets the input 'Band Scale'. Returns its outputs by name."""
        node = self.node("ShaderNodeGroup", node_tree=group)
        for name, value in inputs.items():
            self.connect(value, node.inputs[name.replace("_", " ").title()])
        return {s.name: Socket(self, s) for s in node.outputs}

    def principled(self, **inputs: Operand) -> bpy.types.Node:
        node = self.node("ShaderNodeBsdfPrincipled")
        for name, value in inputs.items():
            self.connect(value, node.inputs[name.replace("_", " ").title()])
        return node

    def bump(self, height: Socket, surface: bpy.types.Node, distance: Operand) -> None:
        """Relief of that height, in units of length, on the surface."""
        node = self.node("ShaderNodeBump")
        self.connect(height, node.inputs["Height"])
        self.connect(distance, node.inputs["Distance"])
        self.tree.links.new(node.outputs["Normal"], surface.inputs["Normal"])

    def surface(self, shader: bpy.types.Node) -> None:
        """The end of a material."""
        output = self.node("ShaderNodeOutputMaterial")
        self.tree.links.new(shader.outputs[0], output.inputs["Surface"])
        self.arrange()

    def arrange(self) -> None:
        """Columns by distance from the outputs; inside a column the nodes keep the order of their making."""
        depth: dict[bpy.types.Node, int] = {}
        for node in reversed(self.tree.nodes[:]):  # makers come before users
            users = [link.to_node for socket in node.outputs for link in socket.links]
            depth[node] = 1 + max((depth.get(user, 0) for user in users), default=-1)
        filled: dict[int, float] = {}
        for node in self.tree.nodes:
            y = filled.get(depth[node], 0.0)
            node.location = (-COLUMN * depth[node], y)
            visible = sum(1 for s in (*node.inputs, *node.outputs) if s.enabled and not s.hide)
            filled[depth[node]] = y - ROW - 24.0 * visible


def _numbered(sockets) -> list[bpy.types.NodeSocket]:
    """Of the node that captures, the sockets of what it captures."""
    return [socket for socket in sockets if socket.name.startswith("Value")]


def node_group(
    name: str, kind: str = "ShaderNodeTree"
) -> Callable[[Callable[[Tree], None]], Callable[[], bpy.types.NodeTree]]:
    """Decorator of a function that fills a node group: the group is built once in a file and shared by all that use it,
    materials, or modifiers where its kind is GeometryNodeTree. Building it again in place would cut the links of its
    users, so a group of an older add-on stays with them."""

    def decorate(fill: Callable[[Tree], None]) -> Callable[[], bpy.types.NodeTree]:
        @functools.wraps(fill)
        def shared() -> bpy.types.NodeTree:
            mark = f"{name} {VERSION}"
            for known in bpy.data.node_groups:
                if known.get("stormfield") == mark:
                    return known
            made = cast(Any, bpy.data.node_groups.new(name, kind))
            made["stormfield"] = mark
            if kind == "GeometryNodeTree":
                made.is_modifier = True
            fill(Tree(made))
            return made

        return shared

    return decorate


def add_input(
    tree: Tree, name: str, default: float | Sequence[float], low: float = 0.0, high: float = 1.0, tip: str = ""
) -> None:
    """One input of a group: a float with limits, or a colour when the default has four numbers."""
    kind = "NodeSocketFloat" if isinstance(default, int | float) else "NodeSocketColor"
    socket = tree.tree.interface.new_socket(name, in_out="INPUT", socket_type=kind, description=tip)
    socket.default_value = default
    if kind == "NodeSocketFloat":
        socket.min_value, socket.max_value = low, high


def add_socket(tree: Tree, name: str, kind: str) -> None:
    """One input of a group, of any kind, as Blender makes it."""
    tree.tree.interface.new_socket(name, in_out="INPUT", socket_type=kind)


def group_inputs(tree: Tree) -> dict[str, Socket]:
    node = tree.node("NodeGroupInput")
    return {s.name: Socket(tree, s) for s in node.outputs if s.name}


def set_outputs(tree: Tree, **outputs: Socket) -> None:
    """Declare and connect the group's outputs; keyword 'weight_a' makes 'Weight A'."""
    kinds = {"VALUE": "NodeSocketFloat", "VECTOR": "NodeSocketVector", "RGBA": "NodeSocketColor"}
    kinds |= {"SHADER": "NodeSocketShader", "GEOMETRY": "NodeSocketGeometry"}
    names = {key: key.replace("_", " ").title() for key in outputs}
    for key, value in outputs.items():
        tree.tree.interface.new_socket(names[key], in_out="OUTPUT", socket_type=kinds[value.socket.type])
    node = tree.node("NodeGroupOutput")
    for key, value in outputs.items():
        tree.connect(value, node.inputs[names[key]])
    tree.arrange()


def new_material(name: str) -> tuple[bpy.types.Material, Tree]:
    """A material of that name, or one with a number where another has it."""
    material = bpy.data.materials.new(name)
    if material.node_tree is None:  # before Blender 5 a material has no nodes until asked
        material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, Tree(material.node_tree)
