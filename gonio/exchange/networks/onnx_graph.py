"""The network as an ONNX graph, from directions to BRDF."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from gonio.errors import MissingExtraError
from gonio.exchange.networks.activations import activation_of
from gonio.exchange.networks.expression import CONSTANT, INPUT, in_order
from gonio.exchange.networks.formats import network_format
from gonio.exchange.networks.inputs import inputs_of
from gonio.words import utf8

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike

    from gonio.exchange.networks.expression import Expression
    from gonio.exchange.networks.portable import Portable

# of 2022: what has read ONNX since then reads it
_OPSET, _FILE_VERSION = 17, 8
_LARGEST = 50.0
_OPERATORS = {
    "add": "Add", "subtract": "Sub", "multiply": "Mul", "divide": "Div", "sqrt": "Sqrt",
    "exp": "Exp", "log": "Log", "absolute": "Abs", "sin": "Sin", "cos": "Cos", "tanh": "Tanh",
    "erf": "Erf", "maximum": "Max", "minimum": "Min",
}  # fmt: skip


class Graph:
    """Nodes and numbers of a graph in the making; every node has one result, known by its name."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.numbers: list[Any] = []

    def add(self, operator: str, *operands: str, **attributes: Any) -> str:
        """Add a node and return the name of its result."""
        from onnx import helper

        name = f"n{len(self.nodes)}"
        self.nodes.append(helper.make_node(operator, operands, [name], **attributes))
        return name

    def number(self, values: ArrayLike) -> str:
        """Add numbers in single precision and return their name."""
        from onnx import numpy_helper

        name = f"c{len(self.numbers)}"
        self.numbers.append(numpy_helper.from_array(np.asarray(values, np.float32), name))
        return name

    def column(self, vectors: str, index: int) -> str:
        """Return one coordinate of vectors of shape (n, 3), shape (n, 1)."""
        from onnx import numpy_helper

        name = f"i{len(self.numbers)}"
        self.numbers.append(numpy_helper.from_array(np.array([index], np.int64), name))
        return self.add("Gather", vectors, name, axis=1)

    def formulas(self, results: Sequence[Expression], inputs: Mapping[str, str]) -> list[str]:
        """Return the names of the results of formulas, whose inputs have names in the graph."""
        names: dict[int, str] = {}
        for each in in_order(results):
            if each.operation == INPUT:
                names[id(each)] = inputs[each.name]
            elif each.operation == CONSTANT:
                names[id(each)] = self.number(each.value)
            else:
                names[id(each)] = self._operation(each, [names[id(x)] for x in each.operands])
        return [names[id(each)] for each in results]

    def _operation(self, each: Expression, operands: list[str]) -> str:
        if each.operation == "where_less":
            return self.add("Where", self.add("Less", *operands[:2]), *operands[2:])
        if each.operation == "atan2":
            return self._atan2(*operands)
        return self.add(_OPERATORS[each.operation], *operands)

    def _atan2(self, y: str, x: str) -> str:
        """Return atan2, which ONNX lacks: atan(y / x), half a turn further where x < 0."""
        zero, tiny = self.number(0.0), self.number(1e-30)
        upright = self.add("Less", self.add("Abs", x), tiny)
        quotient = self.add("Div", y, self.add("Where", upright, tiny, x))
        down = self.add("Less", y, zero)
        turn = self.add("Where", down, self.number(-math.pi), self.number(math.pi))
        behind = self.add("Less", x, zero)
        more = self.add("Where", behind, turn, zero)
        return self.add("Add", self.add("Atan", quotient), more)


def model_of(network: Portable) -> Any:
    """Return the `onnx.ModelProto`.

    Raises
    ------
    gonio.errors.MissingExtraError
        When onnx is not installed.
    """
    try:
        from onnx import TensorProto, helper
    except ImportError:
        raise MissingExtraError("onnx", "onnx") from None
    graph = Graph()
    result = _result(graph, network)
    graph.add("Identity", result)
    graph.nodes[-1].output[0] = "rgb"

    def vectors(name: str) -> Any:
        return helper.make_tensor_value_info(name, TensorProto.FLOAT, ["n", 3])

    made = helper.make_graph(
        graph.nodes, "gonio", [vectors("light"), vectors("view")], [vectors("rgb")], graph.numbers
    )
    model = helper.make_model(
        made,
        opset_imports=[helper.make_opsetid("", _OPSET)],
        ir_version=_FILE_VERSION,
        producer_name="gonio",
        doc_string=f"{network.description}. BRDF in 1/sr of unit vectors; z is the normal.",
    )
    properties = {"name": utf8(network.name).decode(), "color_space": network.color_space}
    helper.set_model_props(model, properties)
    return model


def _result(graph: Graph, network: Portable) -> str:
    inputs = {
        f"{vector[0]}{axis}": graph.column(vector, index)
        for vector in ("light", "view")
        for index, axis in enumerate("xyz")
    }
    signal = graph.add("Concat", *graph.formulas(inputs_of(network.encoding), inputs), axis=1)
    *hidden, last = network.layers
    for layer in hidden:
        total = _layer(graph, layer, signal)
        (signal,) = graph.formulas([activation_of(network.activation)], {"x": total})
    value = _layer(graph, last, signal)
    if network.logarithmic:
        power = graph.add("Exp", graph.add("Min", value, graph.number(_LARGEST)))
        value = graph.add("Sub", power, graph.number(0.01))
    zero = graph.number(0.0)
    scaled = graph.add("Mul", graph.add("Max", value, zero), graph.number(network.scale))
    for height in ("lz", "vz"):
        above = graph.add("Less", zero, inputs[height])
        scaled = graph.add("Where", above, scaled, zero)
    return scaled


def _layer(graph: Graph, layer: np.ndarray[Any, Any], signal: str) -> str:
    weights, bias = graph.number(layer[:, :-1]), graph.number(layer[:, -1])
    return graph.add("Gemm", signal, weights, bias, transB=1)


FORMAT = network_format(
    name="onnx",
    suffix=".onnx",
    title="ONNX graph, light and view (n, 3) to rgb (n, 3)",
    content=lambda network, source, path: model_of(network).SerializeToString(),
)
