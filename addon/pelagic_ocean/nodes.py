# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees written as formulas: a Value is the output of a node, and calculating with it adds nodes.

    tree = Tree(group)
    a = tree.attribute("whitecap_coverage", "Fac")
    tree.add("ShaderNodeBsdfDiffuse", Color=(0.5 * a + 0.2).clamped())
"""

import bpy

_SPACING = (190, 150)  # of the nodes in the editor
_ROWS = 12


class Value:
    """A number or a vector that a node puts out."""

    def __init__(self, tree, socket):
        self.tree, self.socket = tree, socket

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
        return [Value(self.tree, output) for output in node.outputs]


class Tree:
    """Adds nodes to a node tree that is empty at first."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def node(self, kind, inputs=(), **settings):
        """inputs: numbers, tuples or Values by the socket's name or number."""
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        for name, value in dict(inputs).items():
            if isinstance(value, Value):
                self.tree.links.new(value.socket, node.inputs[name])
            else:
                node.inputs[name].default_value = value
        return node

    def add(self, kind, inputs=(), output=0, **settings):
        return Value(self, self.node(kind, inputs, **settings).outputs[output])

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

    def map_range(self, value, low, high, smooth=True):
        """0 … 1 while the value goes from low to high."""
        return self.add("ShaderNodeMapRange", {"Value": value, "From Min": low, "From Max": high},
                        interpolation_type="SMOOTHSTEP" if smooth else "LINEAR")

    def mix(self, part, a, b):
        """a + part·(b − a), numbers or vectors."""
        return a + (b - a) * part

    def arrange(self):
        """Places each node to the right of what it uses."""
        columns = {}

        def column_of(node):
            if node not in columns:
                columns[node] = 0
                before = [link.from_node for socket in node.inputs for link in socket.links]
                columns[node] = 1 + max((column_of(other) for other in before), default=-1)
            return columns[node]

        rows = {}
        for node in self.tree.nodes:
            column = column_of(node)
            rows[column] = rows.get(column, -1) + 1
            node.location = (column * _SPACING[0] + rows[column] // _ROWS * 40, -(rows[column] % _ROWS) * _SPACING[1])


def new_group(name):
    return bpy.data.node_groups.new(name, "ShaderNodeTree")
