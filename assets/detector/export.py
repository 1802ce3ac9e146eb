#!/usr/bin/env python3
"""Writes trained weights as an ONNX file with the metadata that YOLO exports carry.

    python export.py run/last.pt plumbline-detector.onnx --zoom 1.5

`--zoom` says how many pixels of the network there are per pixel of an eye's image: toys are some
20 pixels wide, and the edges of a box are found more exactly on a larger picture.
"""

import argparse

import numpy as np
import onnx
import torch

from any_size import rewritten
from augment import NAMES
from network import STRIDES, Detector, Exported, fold

# Of an eye's image.
HEIGHT, WIDTH = 480, 640
# Sides of the input are multiples of the widest stride.
STRIDE = max(STRIDES)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("weights")
    arguments.add_argument("out")
    arguments.add_argument("--zoom", type=float, default=1.5)
    args = arguments.parse_args()
    height, width = (round(side * args.zoom / STRIDE) * STRIDE for side in (HEIGHT, WIDTH))
    export(args.weights, args.out, height, width)


def export(weights, out, height, width):
    net = Detector()
    net.load_state_dict(torch.load(weights, map_location="cpu", weights_only=True)["net"])
    model = Exported(fold(net.eval()), height, width).eval()
    example = torch.rand(1, 3, height, width)
    torch.onnx.export(
        model, example, out, opset_version=17, dynamo=False, input_names=["images"], output_names=["output0"]
    )
    file = onnx.load(out)
    known = {
        "description": "Plumbline detector, EfficientNet-Lite0 with a small pyramid",
        "license": "MIT OR Apache-2.0; backbone from Apache-2.0 weights",
        "task": "detect",
        "stride": str(STRIDE),
        "batch": "1",
        "imgsz": str([height, width]),
        "names": str(dict(enumerate(NAMES))),
    }
    for key, value in known.items():
        entry = file.metadata_props.add()
        entry.key, entry.value = key, value
    onnx.save(rewritten(file), out)
    import onnxruntime

    session = onnxruntime.InferenceSession(out, providers=["CPUExecutionProvider"])
    got = session.run(None, {"images": example.numpy()})[0]
    with torch.no_grad():
        expected = model(example).numpy()
    worst = float(np.abs(got - expected).max())
    print(f"{out}: output {got.shape}, differs from the network by at most {worst:.1e}")
    if not worst < 0.05:
        raise SystemExit("the file does not compute what the network computes")


if __name__ == "__main__":
    main()
