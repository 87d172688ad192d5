# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees written as formulas: a Value is the output of a node, and calculating with it adds nodes.

    tree = Tree(material.node_tree)
    coverage = tree.attribute("whitecap_coverage", "Fac")
    tree.add("ShaderNodeBsdfDiffuse", {"Color": 0.5 * coverage + 0.2})

What a tree does is looked through again at each change to it, so large ones are made of groups.
"""

import bpy

from . import compat

MARK = "pelagic_group"  # on a node group that call() made: its name and version
VERSION = 7

_SPACING = (190, 150)  # of the nodes in the editor


class Value:
    """A number or a vector that a node puts out."""

    def __init__(self, tree, socket, column=0):
        self.tree, self.socket, self.column = tree, socket, column  # column: of its node in the editor

    @property
    def is_vector(self):
        return self.socket.type in {"VECTOR", "RGBA"}

    def _math(self, operation, *others):
        if self.is_vector or any(isinstance(other, Value) and other.is_vector for other in others):
            return self.tree.vector_math(operation, self, *others)
        return self.tree.math(operation, self, *others)

    def _scaled(self, factor):
        return self.tree.vector_math("SCALE", self, Scale=factor)

    def __add__(self, other):
        return self._math("ADD", other)

    def __sub__(self, other):
        return self._math("SUBTRACT", other)

    def __rsub__(self, other):
        return self.tree.math("SUBTRACT", other, self)

    def __mul__(self, other):
        other_is_vector = isinstance(other, (Value, tuple)) and (isinstance(other, tuple) or other.is_vector)
        if self.is_vector != other_is_vector:
            return self._scaled(other) if self.is_vector else other._scaled(self)
        return self._math("MULTIPLY", other)

    def __truediv__(self, other):
        return self * (1.0 / other) if self.is_vector else self._math("DIVIDE", other)

    def __rtruediv__(self, other):
        return self.tree.math("DIVIDE", other, self)

    def __neg__(self):
        return self * -1.0

    __radd__, __rmul__ = __add__, __mul__

    def plus_product(self, a, b):
        """self + a·b, one node; numbers."""
        return self.tree.math("MULTIPLY_ADD", a, b, self)

    def at_least(self, other):
        return self._math("MAXIMUM", other)

    def at_most(self, other):
        return self._math("MINIMUM", other)

    def clamped(self):
        """Within 0 … 1."""
        return self.tree.math("ADD", self, 0.0, clamp=True)

    def above(self, other):
        """1 where it is larger, else 0."""
        return self.tree.math("GREATER_THAN", self, other)

    def sqrt(self):
        return self.tree.math("SQRT", self.at_least(0.0))

    def exp(self):
        return self.tree.math("EXPONENT", self)

    def dot(self, other):
        return self.tree.vector_math("DOT_PRODUCT", self, other, output="Value")

    def length(self):
        return self.tree.vector_math("LENGTH", self, output="Value")

    def normalized(self):
        return self.tree.vector_math("NORMALIZE", self)

    def parts(self):
        """The three components of a vector."""
        node = self.tree.node("ShaderNodeSeparateXYZ", {0: self})
        return [self.tree.value(node, output) for output in range(3)]


class Tree:
    """Adds nodes to a node tree, which is empty at first unless it keeps what it has."""

    def __init__(self, tree, keeps=False):
        self.tree = tree
        self._columns = {}  # of the nodes
        self._rows = {}  # that a column has
        if not keeps:
            tree.nodes.clear()

    def node(self, kind, inputs=(), **settings):
        """inputs: numbers, tuples or Values by the socket's name or number."""
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            if getattr(node, name) != value:
                setattr(node, name, value)
        column = 0
        for name, value in dict(inputs).items():
            if isinstance(value, Value):
                self.tree.links.new(value.socket, node.inputs[name])
                column = max(column, 1 + value.column)
            else:
                node.inputs[name].default_value = value
        self._place(node, column)
        return node

    def _place(self, node, column):
        """To the right of what it uses."""
        self._columns[node] = column
        row = self._rows[column] = self._rows.get(column, -1) + 1
        node.location = column * _SPACING[0], -row * _SPACING[1]

    def call(self, name, build, inputs):
        """Adds the node group of this name, whose tree build(tree, {input: Value}) makes the first time. inputs: numbers,
        tuples or Values by name. Returns the group's outputs, {name: Value}, which are what build() returned."""
        node = self.node("ShaderNodeGroup", inputs, node_tree=_shared_group(name, build, inputs))
        node.name = name
        return {socket.name: self.value(node, socket.name) for socket in node.outputs}

    def add(self, kind, inputs=(), output=0, **settings):
        return self.value(self.node(kind, inputs, **settings), output)

    def named(self, name, kind, inputs=(), **settings):
        """add() of a node that others find by its name."""
        node = self.node(kind, inputs, **settings)
        node.name = node.label = name
        return self.value(node, 0)

    def value(self, node, output):
        return Value(self, node.outputs[output], self._columns[node])

    def math(self, operation, *values, clamp=False):
        return self.add("ShaderNodeMath", dict(enumerate(values)), operation=operation, use_clamp=clamp)

    def vector_math(self, operation, *values, output="Vector", **inputs):
        values = {i: (value,) * 3 if isinstance(value, (int, float)) else value for i, value in enumerate(values)}
        return self.add("ShaderNodeVectorMath", {**values, **inputs}, output, operation=operation)

    def vector(self, x=0.0, y=0.0, z=0.0):
        return self.add("ShaderNodeCombineXYZ", {0: x, 1: y, 2: z})

    def attribute(self, name, output="Vector"):
        """Of the mesh; 0 where it has none of the name."""
        return self.add("ShaderNodeAttribute", output=output, attribute_name=name)

    def map_range(self, value, low, high):
        """0 … 1 while the value goes from low to high, smoothly."""
        return self.add("ShaderNodeMapRange", {"Value": value, "From Min": low, "From Max": high},
                        interpolation_type="SMOOTHSTEP")

    def mix(self, part, a, b):
        """a + part·(b − a), numbers or vectors."""
        return a + (b - a) * part


def _shared_group(name, build, inputs):
    mark = f"{name} {VERSION}"
    for group in bpy.data.node_groups:
        if group.get(MARK) == mark:
            return group
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    group[MARK] = mark
    for socket, value in inputs.items():
        is_vector = value.is_vector if isinstance(value, Value) else isinstance(value, tuple)
        compat.new_group_socket(group, socket, "Vector" if is_vector else "Float",
                                default=None if isinstance(value, Value) else value)
    tree = Tree(group)
    arrived = tree.node("NodeGroupInput").outputs
    made = build(tree, {socket: Value(tree, arrived[socket]) for socket in inputs})
    for socket, value in made.items():
        compat.new_group_socket(group, socket, "Vector" if value.is_vector else "Float", is_output=True)
    tree.node("NodeGroupOutput", made)
    return group
