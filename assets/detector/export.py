#!/usr/bin/env python3
"""Writes trained weights as an ONNX file with the metadata that YOLO exports carry.

    python export.py run/last.pt plumbline-detector.onnx
"""

import sys

import numpy as np
import onnx
import torch

from augment import NAMES
from network import Detector, Exported, fold

HEIGHT, WIDTH = 480, 640


def main(weights, out):
    net = Detector()
    net.load_state_dict(torch.load(weights, map_location="cpu", weights_only=True)["net"])
    model = Exported(fold(net.eval()), HEIGHT, WIDTH).eval()
    example = torch.rand(1, 3, HEIGHT, WIDTH)
    torch.onnx.export(
        model, example, out, opset_version=17, dynamo=False, input_names=["images"], output_names=["output0"]
    )
    file = onnx.load(out)
    known = {
        "description": "Plumbline detector, EfficientNet-Lite0 with a small pyramid",
        "license": "MIT OR Apache-2.0; backbone from Apache-2.0 weights",
        "task": "detect",
        "stride": "32",
        "batch": "1",
        "imgsz": str([HEIGHT, WIDTH]),
        "names": str(dict(enumerate(NAMES))),
    }
    for key, value in known.items():
        entry = file.metadata_props.add()
        entry.key, entry.value = key, value
    onnx.save(file, out)
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
    if len(sys.argv) != 3:
        raise SystemExit(__doc__)
    main(*sys.argv[1:])
