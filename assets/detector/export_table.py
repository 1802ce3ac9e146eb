"""Exports the eight detectors of the published comparison to ONNX files.

    python export_table.py OUT [--weights DIR] [--size HEIGHTxWIDTH] [--only yolo12n,yolo12s]

Where DIR holds NAME.pt (weights that the laboratory trained, for example yolo12s.pt), these are
exported. Otherwise the network is built from its description with random weights: it finds
nothing, but its time is that of the trained one. Such a file is called NAME-untrained.onnx and
says so in its metadata, which `plumbline detect-eval` prints.

Needs ultralytics and onnx (AGPL-3.0 and Apache-2.0); nothing of the program needs this script.
"""

import argparse
import pathlib
import shutil
import tempfile

NETWORKS = {
    "yolo12n": "yolo12n.yaml",
    "yolo12s": "yolo12s.yaml",
    "yolo12m": "yolo12m.yaml",
    "yolo11n": "yolo11n.yaml",
    "yolo11s": "yolo11s.yaml",
    "yolo11m": "yolo11m.yaml",
    "yolov3": "yolov3.yaml",
    "yolov3-spp": "yolov3-spp.yaml",
}
CLASSES = ["Banana", "Duck", "LeftHand", "Mushroom", "Onion", "Orange", "RightHand", "Tomato"]


def untrained(description):
    """A network with random weights and the eight classes."""
    import torch
    from ultralytics import YOLO
    from ultralytics.nn.tasks import DetectionModel

    torch.manual_seed(1)
    model = YOLO(description)
    network = DetectionModel(description, nc=len(CLASSES), verbose=False)
    network.names = dict(enumerate(CLASSES))
    network.args, network.task = model.model.args, model.task
    model.model = network
    return model


def say_untrained(file):
    """Marks a file in its metadata."""
    import onnx

    model = onnx.load(str(file))
    for entry in model.metadata_props:
        if entry.key == "author":
            entry.value = "untrained (random weights), exported with ultralytics"
    onnx.save(model, str(file))


def export(name, weights, out, size):
    """Exports one; gives the file."""
    from ultralytics import YOLO

    trained = weights / f"{name}.pt" if weights else None
    is_trained = trained is not None and trained.is_file()
    model = YOLO(str(trained)) if is_trained else untrained(NETWORKS[name])
    target = out / (f"{name}.onnx" if is_trained else f"{name}-untrained.onnx")
    with tempfile.TemporaryDirectory(dir=out) as scratch:
        # The export writes beside the weights, under their name.
        model.model.pt_path = str(pathlib.Path(scratch) / f"{name}.pt")
        made = model.export(format="onnx", imgsz=size, dynamic=False, simplify=False, half=False)
        if not is_trained:
            say_untrained(made)
        shutil.move(made, target)
    return target


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path, help="folder for the ONNX files")
    parser.add_argument("--weights", type=pathlib.Path, help="folder with NAME.pt of trained networks")
    parser.add_argument("--size", default="480x640", help="height x width of the images, multiples of 32")
    parser.add_argument("--only", help="some of: " + ",".join(NETWORKS))
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    size = [int(side) for side in arguments.size.split("x")]
    names = arguments.only.split(",") if arguments.only else list(NETWORKS)
    for name in names:
        file = export(name, arguments.weights, arguments.out, size)
        print(f"{file}: {file.stat().st_size / 1e6:.0f} MB", flush=True)


if __name__ == "__main__":
    main()
