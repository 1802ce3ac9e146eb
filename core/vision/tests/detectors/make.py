"""Makes the tiny networks of these tests; needs the packages onnx and numpy.

    python make.py [FOLDER]

Each answers with boxes that are known. Where the input matters, the confidence of the first
box is the mean of the red plane, so that channel order, scale and padding show in it.
"""

import pathlib
import sys

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

OUT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
NAMES = ["Banana", "Duck", "LeftHand"]

# x, y, width, height, confidence of the three classes; on an input of 64x64
BOXES = np.array(
    [
        [20, 30, 10, 8, 0.90, 0.10, 0.05],  # a banana
        [21, 30, 10, 8, 0.80, 0.10, 0.05],  # the same banana again
        [20, 30, 10, 8, 0.05, 0.70, 0.05],  # a duck at the same place
        [50, 40, 6, 12, 0.05, 0.10, 0.60],  # a hand
        [40, 20, 4, 4, 0.20, 0.10, 0.05],  # not sure enough
    ],
    np.float32,
)
# edges, confidence, class
ENDED = np.array(
    [[15, 26, 25, 34, 0.9, 0], [15, 26, 25, 34, 0.7, 1], [47, 34, 53, 46, 0.6, 2], [0, 0, 0, 0, 0, 0]],
    np.float32,
)
# Boxes of 64x64 with strides 8, 16, 32.
PLACES = 84


def raw(rows=BOXES):
    """1x(4+classes)xN, padded with boxes of no confidence."""
    head = np.zeros((1, rows.shape[1], PLACES), np.float32)
    head[0, :, : len(rows)] = rows.T
    return head


def metadata(**changed):
    values = {
        "author": "Plumbline tests",
        "version": "1",
        "task": "detect",
        "stride": "32",
        "imgsz": "[64, 64]",
        "names": str(dict(enumerate(NAMES))),
        "end2end": "False",
    }
    values.update(changed)
    return {key: value for key, value in values.items() if value is not None}


def save(name, answer, *, size=(64, 64), batch=1, channels=3, number=np.float32, meta=None,
         nodes=None, initializers=(), inputs=None, outputs=None):
    """A network that answers with a constant, plus 0 times a value of its input."""
    of = helper.np_dtype_to_tensor_dtype(np.dtype(number))
    image = helper.make_tensor_value_info("images", of, [batch, channels, *size])
    if nodes is None:
        shape = list(answer.shape)
        nodes, initializers = constant(answer.astype(number), number)
        outputs = [helper.make_tensor_value_info("output0", of, shape)]
    graph = helper.make_graph(nodes, name, inputs or [image], outputs, list(initializers))
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    helper.set_model_props(model, metadata() if meta is None else meta)
    onnx.checker.check_model(model)
    (OUT / f"{name}.onnx").write_bytes(model.SerializeToString())


def constant(answer, number):
    """answer + 0 * mean(input)."""
    initializers = [
        numpy_helper.from_array(answer, "answer"),
        numpy_helper.from_array(np.array(0, number), "zero"),
    ]
    nodes = [
        helper.make_node("ReduceMean", ["images"], ["mean"], keepdims=0),
        helper.make_node("Mul", ["mean", "zero"], ["nothing"]),
        helper.make_node("Add", ["answer", "nothing"], ["output0"]),
    ]
    return nodes, initializers


def seeing(name, size=(64, 64), declared=(64, 64)):
    """The middle of its only box is (mean red, mean green) * 64, its size mean blue * 64."""
    weights = [
        numpy_helper.from_array(np.array(64, np.float32), "scale"),
        numpy_helper.from_array(np.array([[0.9], [0.0], [0.0]], np.float32).reshape(1, 3, 1), "scores"),
        numpy_helper.from_array(np.array([1, 3, 1], np.int64), "shape"),
    ]
    nodes = [
        helper.make_node("ReduceMean", ["images"], ["means"], axes=[2, 3], keepdims=0),
        helper.make_node("Reshape", ["means", "shape"], ["column"]),
        helper.make_node("Mul", ["column", "scale"], ["scaled"]),
        helper.make_node("Slice", ["scaled", "two", "three", "one"], ["blue"]),
        helper.make_node("Concat", ["scaled", "blue", "scores"], ["output0"], axis=1),
    ]
    for key, value in {"one": 1, "two": 2, "three": 3}.items():
        weights.append(numpy_helper.from_array(np.array([value], np.int64), key))
    outputs = [helper.make_tensor_value_info("output0", TensorProto.FLOAT, [1, 7, 1])]
    save(name, None, size=declared, nodes=nodes, initializers=weights, outputs=outputs)


def open_shape():
    """Declares no side of its output, as exports of any size do."""
    nodes, weights = constant(raw(), np.float32)
    outputs = [helper.make_tensor_value_info("output0", TensorProto.FLOAT, ["batch", "rows", "boxes"])]
    # Sides that come from a value are not inferred from the graph.
    nodes[-1] = helper.make_node("Add", ["answer", "nothing"], ["sum"])
    nodes += [
        helper.make_node("Shape", ["sum"], ["shape"]),
        helper.make_node("Reshape", ["sum", "shape"], ["output0"]),
    ]
    save("open-shape", None, size=("height", "width"), nodes=nodes, initializers=weights, outputs=outputs)


def throwing():
    """Asks for a row that is not there, which shows only when it runs."""
    weights = [
        numpy_helper.from_array(raw(), "answer"),
        numpy_helper.from_array(np.array(1e6, np.float32), "far"),
    ]
    nodes = [
        helper.make_node("ReduceMax", ["images"], ["most"], keepdims=0),
        helper.make_node("Mul", ["most", "far"], ["number"]),
        helper.make_node("Cast", ["number"], ["row"], to=TensorProto.INT64),
        helper.make_node("Gather", ["answer", "row"], ["picked"], axis=1),
        helper.make_node("Add", ["answer", "picked"], ["output0"]),
    ]
    outputs = [helper.make_tensor_value_info("output0", TensorProto.FLOAT, [1, 7, PLACES])]
    save("throwing", None, nodes=nodes, initializers=weights, outputs=outputs)


def segmenting():
    nodes, weights = constant(raw(), np.float32)
    nodes.append(helper.make_node("Identity", ["masks"], ["output1"]))
    weights.append(numpy_helper.from_array(np.zeros((1, 2, 4, 4), np.float32), "masks"))
    outputs = [
        helper.make_tensor_value_info("output0", TensorProto.FLOAT, [1, 7, PLACES]),
        helper.make_tensor_value_info("output1", TensorProto.FLOAT, [1, 2, 4, 4]),
    ]
    save("segmenting", None, nodes=nodes, initializers=weights, outputs=outputs, meta={})


def mixed():
    """float16 in, float32 out."""
    nodes, weights = constant(raw(), np.float32)
    nodes[0] = helper.make_node("ReduceMean", ["wide"], ["mean"], keepdims=0)
    nodes.insert(0, helper.make_node("Cast", ["images"], ["wide"], to=TensorProto.FLOAT))
    outputs = [helper.make_tensor_value_info("output0", TensorProto.FLOAT, [1, 7, PLACES])]
    save("mixed", None, number=np.float16, nodes=nodes, initializers=weights, outputs=outputs)


save("raw", raw())
save("transposed", raw().transpose(0, 2, 1))
save("end-to-end", ENDED[None], meta=metadata(end2end="True"))
save("end-to-end-unnamed", ENDED[None], meta={})
save("float16", raw(), number=np.float16)
save("end-to-end-float16", ENDED[None], number=np.float16, meta=metadata(end2end="True"))
mixed()
seeing("seeing")
seeing("seeing-any-size", declared=("height", "width"))
save("unnamed", raw(), meta={})
save("reordered", raw(), meta=metadata(names="{0: 'Duck', 1: 'Banana', 2: 'LeftHand'}"))
save("eighty", raw(np.concatenate([BOXES, np.zeros((5, 77), np.float32)], 1)))
save("alien-class", np.where(np.arange(6) == 5, 7, ENDED)[None].astype(np.float32))
spoiled = raw()
spoiled[0, 4, 2] = np.nan
save("nan", spoiled)
open_shape()
throwing()
segmenting()
save("posing", raw(), meta=metadata(task="pose"))
save("classifying", np.zeros((1, 3), np.float32), meta={})
save("depth", np.zeros((1, 1, 8, 8), np.float32), meta={})
save("gray", raw(), channels=1)
save("four-at-once", raw(), batch=4)
save("objectness", np.zeros((1, 252, 8), np.float32))
for path in sorted(OUT.glob("*.onnx")):
    print(f"{path.stat().st_size:6d} {path.name}")
