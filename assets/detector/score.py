"""Mean average precision of a network in training (COCO rule, pycocotools). The scores that are
published come from `plumbline detect-eval` on the exported file."""

import contextlib
import io

import cv2
import numpy as np
import torch
from torchvision.ops import batched_nms

from augment import NAMES, decode
from network import STRIDES, anchors, boxes_of


@torch.no_grad()
def detect(net, image, device, zoom=1.0, floor=0.001, iou=0.7, most=300):
    """[n, 6]: corners, score, class. The network sees the image enlarged by about `zoom`."""
    seen_as = np.array(image.shape[:2])
    height, width = (np.round(seen_as * zoom / max(STRIDES)) * max(STRIDES)).astype(int).tolist()
    shrink = np.tile(seen_as[::-1] / [width, height], 2)
    image = cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR)
    x = torch.from_numpy(image).to(device).permute(2, 0, 1)[None].float() / 255
    edges, names = net(x.contiguous(memory_format=torch.channels_last))
    points, strides = anchors(height, width, device)
    boxes = boxes_of(edges, points, strides)[0]
    boxes[:, 0::2].clamp_(0, width)
    boxes[:, 1::2].clamp_(0, height)
    scores, classes = names[0].sigmoid().max(0)
    keep = scores > floor
    boxes, scores, classes = boxes[keep], scores[keep], classes[keep]
    keep = batched_nms(boxes, scores, classes, iou)[:most]
    found = torch.cat([boxes[keep], scores[keep, None], classes[keep, None].float()], 1).cpu().numpy()
    found[:, :4] *= shrink
    return found


def score(net, items, device, zoom=1.0):
    from pycocotools.coco import COCO
    from pycocotools.cocoeval import COCOeval

    net.eval()
    truth, found = [], []
    for number, (data, boxes) in enumerate(items):
        image = decode(data)
        for row in boxes:
            x0, y0, x1, y1 = map(float, row[1:])
            truth.append(
                {"id": len(truth) + 1, "image_id": number, "category_id": int(row[0]), "iscrowd": 0,
                 "bbox": [x0, y0, x1 - x0, y1 - y0], "area": (x1 - x0) * (y1 - y0)}
            )
        for x0, y0, x1, y1, confidence, name in detect(net, image, device, zoom).tolist():
            found.append(
                {"image_id": number, "category_id": int(name), "score": confidence, "bbox": [x0, y0, x1 - x0, y1 - y0]}
            )
    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO()
        coco.dataset = {
            "images": [{"id": i} for i in range(len(items))],
            "categories": [{"id": i, "name": n} for i, n in enumerate(NAMES)],
            "annotations": truth,
        }
        coco.createIndex()
        judge = COCOeval(coco, coco.loadRes(found) if found else COCO(), "bbox")
        judge.evaluate()
        judge.accumulate()
        judge.summarize()
    precision = judge.eval["precision"][:, :, :, 0, 2]
    mean = lambda p: float(p[p > -1].mean()) if (p > -1).any() else float("nan")
    return {
        "map50_95": mean(precision),
        "map50": mean(precision[0]),
        "per_class": {name: mean(precision[:, :, i]) for i, name in enumerate(NAMES)},
        "per_class_50": {name: mean(precision[0, :, i]) for i, name in enumerate(NAMES)},
    }
