#!/usr/bin/env python3
"""Makes an exported network take images of any size, and rewrites what computes slowly.

    python any_size.py plumbline-detector.onnx plumbline-detector.onnx

The weights stay as they are. What changes:

* Height and width are open. Middles of cells and strides, numbers in the file for one size, are
  computed from the shapes of the heads' features.
* Paddings to the right and below move into the convolutions that follow them. As nodes of their own
  they made the runtime copy its largest features twice, out of and back into its blocked layout.
* What is finer than the finest head is taken into it by a convolution as wide as its stride, in place
  of a transposition and a convolution of one pixel: the same sums.

The file that comes out is compared with the one that goes in, on noise of the old size.
"""

import argparse
import ast

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

STRIDES = (8, 16, 32)
BINS = 16
HEIGHT, WIDTH = "height", "width"


class Graph:
    """A graph, its constants, and who makes and who reads what."""

    def __init__(self, graph):
        self.graph = graph
        self.constants = {tensor.name: numpy_helper.to_array(tensor) for tensor in graph.initializer}
        for node in graph.node:
            if node.op_type == "Constant":
                self.constants[node.output[0]] = numpy_helper.to_array(node.attribute[0].t)

    def maker(self, name):
        return next((node for node in self.graph.node if name in node.output), None)

    def readers(self, name):
        return [node for node in self.graph.node if name in node.input]

    def put(self, name, values):
        kept = [tensor for tensor in self.graph.initializer if tensor.name != name]
        del self.graph.initializer[:]
        self.graph.initializer.extend([*kept, numpy_helper.from_array(values, name)])
        self.constants[name] = values

    def drop_unread(self):
        """Removes what nothing reads any more."""
        wanted = {output.name for output in self.graph.output}
        kept = []
        for node in reversed(self.graph.node):
            if wanted.intersection(node.output):
                wanted.update(node.input)
                kept.append(node)
        del self.graph.node[:]
        self.graph.node.extend(reversed(kept))
        tensors = [tensor for tensor in self.graph.initializer if tensor.name in wanted]
        del self.graph.initializer[:]
        self.graph.initializer.extend(tensors)


def attribute(node, name):
    return next(item for item in node.attribute if item.name == name)


def set_ints(node, name, values):
    del attribute(node, name).ints[:]
    attribute(node, name).ints.extend(values)


def pads_into_convolutions(graph):
    """`Pad` by zeros at the end of rows and columns, and then `Conv`: one `Conv`."""
    for pad in [node for node in graph.graph.node if node.op_type == "Pad"]:
        (conv,) = graph.readers(pad.output[0])
        weight = graph.constants[conv.input[1]]
        stride = attribute(conv, "strides").ints[0]
        # As `SamePad` has it.
        total = weight.shape[2] - stride
        before, after = total // 2, total - total // 2
        assert list(attribute(conv, "pads").ints) == [0, 0, 0, 0], conv.name
        set_ints(conv, "pads", [before, before, after, after])
        conv.input[0] = pad.input[0]


def unshuffled_into_convolutions(graph):
    """`pixel_unshuffle` and then a convolution of one pixel: one convolution as wide as its stride."""
    for squeeze in [node for node in graph.graph.node if node.op_type == "Squeeze"]:
        (conv,) = graph.readers(squeeze.output[0])
        transpose = graph.maker(graph.maker(squeeze.input[0]).input[0])
        split = graph.maker(transpose.input[0])
        first = graph.maker(graph.maker(split.input[0]).input[0])
        assert (transpose.op_type, first.op_type) == ("Transpose", "Unsqueeze"), conv.name
        # 1 × channels × rows × step × columns × step
        step = int(graph.constants[split.input[1]][-1])
        weight = graph.constants[conv.input[1]]
        out, mixed = weight.shape[:2]
        graph.put(conv.input[1], weight.reshape(out, mixed // step**2, step, step).copy())
        for name in ("kernel_shape", "strides"):
            set_ints(conv, name, [step, step])
        conv.input[0] = first.input[0]


def sides_open(graph):
    """Height and width of the input become free; cells are counted where they come out."""
    new = []

    def add(kind, inputs, name, **attributes):
        new.append(helper.make_node(kind, inputs, [name], name=name, **attributes))
        return name

    def constant(name, values):
        graph.put(name, np.asarray(values))
        return name

    image = graph.graph.input[0].type.tensor_type.shape.dim
    image[2].dim_param, image[3].dim_param = HEIGHT, WIDTH
    edges = graph.maker("/net/Concat_10_output_0")
    graph.put("edges.shape", np.array([1, 4, BINS, -1], np.int64))
    graph.maker("/Reshape_output_0").input[1] = "edges.shape"
    one, zero = constant("cells.one", np.int64(1)), constant("cells.zero", np.int64(0))
    half = constant("cells.half", np.float32(0.5))
    row = constant("cells.row", np.array([1, 1, -1], np.int64))
    column = constant("cells.column", np.array([1, -1, 1], np.int64))
    points, strides = [], []
    for stride, reshaped in zip(STRIDES, edges.input):
        feature = graph.maker(reshaped).input[0]
        at = f"cells.{stride}."
        side = constant(at + "stride", np.float32(stride))
        shape = add("Shape", [feature], at + "shape", start=2)
        grid = add("Concat", [constant(at + "ones", np.array([1], np.int64)), shape], at + "grid", axis=0)
        middles = []
        for index, along in ((1, row), (0, column)):
            axis = f"{at}{index}."
            count = add("Gather", [shape, constant(axis + "index", np.int64(index))], axis + "count", axis=0)
            steps = add("Range", [zero, count, one], axis + "steps")
            steps = add("Cast", [steps], axis + "float", to=TensorProto.FLOAT)
            steps = add("Mul", [add("Add", [steps, half], axis + "middle"), side], axis + "px")
            steps = add("Expand", [add("Reshape", [steps, along], axis + "along"), grid], axis + "spread")
            middles.append(add("Reshape", [steps, row], axis + "flat"))
        points.append(add("Concat", middles, at + "points", axis=1))
        zeros = add("Mul", [middles[0], constant(at + "nothing", np.float32(0))], at + "zeros")
        strides.append(add("Add", [zeros, side], at + "strides"))
    for name, parts, axis in (("points", points, 2), ("strides", strides, 2)):
        kept = [tensor for tensor in graph.graph.initializer if tensor.name != name]
        del graph.graph.initializer[:]
        graph.graph.initializer.extend(kept)
        add("Concat", parts, name, axis=axis)
    # What they are made from stands before them, what reads them after.
    place = list(graph.graph.node).index(edges)
    nodes = list(graph.graph.node)
    del graph.graph.node[:]
    graph.graph.node.extend([*nodes[:place], *new, *nodes[place:]])
    boxes = graph.graph.output[0].type.tensor_type.shape.dim
    boxes[1].dim_value, boxes[2].dim_param = 4 + classes_of(graph), "boxes"


def classes_of(graph):
    """Classes, by the last convolution of the first head."""
    reshaped = graph.maker("/net/Concat_11_output_0").input[0]
    return len(graph.constants[graph.maker(graph.maker(reshaped).input[0]).input[2]])


def rewritten(model):
    """The same network for any size whose sides are multiples of the widest stride."""
    changed = onnx.ModelProto()
    changed.CopyFrom(model)
    graph = Graph(changed.graph)
    pads_into_convolutions(graph)
    unshuffled_into_convolutions(graph)
    sides_open(graph)
    graph.drop_unread()
    del changed.graph.value_info[:]
    onnx.checker.check_model(changed, full_check=True)
    return changed


def worst_difference(before, after, height, width):
    """Largest difference of the two answers to the same noise."""
    import onnxruntime

    image = np.random.default_rng(1).random((1, 3, height, width), np.float32)
    answers = [
        onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"]).run(
            None, {"images": image}
        )[0]
        for model in (before, after)
    ]
    assert answers[0].shape == answers[1].shape, [answer.shape for answer in answers]
    return float(np.abs(answers[0] - answers[1]).max())


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("model")
    arguments.add_argument("out")
    args = arguments.parse_args()
    before = onnx.load(args.model)
    after = rewritten(before)
    known = {entry.key: entry.value for entry in before.metadata_props}
    height, width = ast.literal_eval(known["imgsz"])
    worst = worst_difference(before, after, height, width)
    print(f"{args.out}: differs from {args.model} by at most {worst:.1e}")
    if not worst < 0.05:
        raise SystemExit("it does not compute what it did")
    onnx.save(after, args.out)


if __name__ == "__main__":
    main()
