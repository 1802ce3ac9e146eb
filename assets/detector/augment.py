"""Crops of labeled images, changed at random: place, size, mirror image, color, blur, noise, JPEG."""

import time
from pathlib import Path

import cv2
import numpy as np

LEFT_HAND, RIGHT_HAND = 2, 6
NAMES = ["Banana", "Duck", "LeftHand", "Mushroom", "Onion", "Orange", "RightHand", "Tomato"]


def read_set(folder, part, known=None):
    """(encoded image, boxes [n, 5]: class, corners in pixels) of a data set in YOLO format.

    `known` holds the paths that were read before, for a set that is still being drawn."""
    folder = Path(folder)
    where = f"{part}/*" if part else "**/*"
    items = []
    for path in sorted((folder / "images").glob(where)):
        if path.suffix.lower() not in (".jpg", ".jpeg", ".png") or path in (known or ()):
            continue
        if known is not None:
            if time.time() - path.stat().st_mtime < 10:
                continue
            known.add(path)
        data = np.frombuffer(path.read_bytes(), np.uint8)
        label = folder / "labels" / path.relative_to(folder / "images").with_suffix(".txt")
        rows = [list(map(float, row.split())) for row in label.read_text().splitlines()] if label.exists() else []
        boxes = np.array(rows, np.float32).reshape(-1, 5)
        height, width = cv2.imdecode(data, cv2.IMREAD_COLOR).shape[:2]
        middle, size = boxes[:, 1:3] * [width, height], boxes[:, 3:5] * [width, height]
        items.append((data, np.concatenate([boxes[:, :1], middle - size / 2, middle + size / 2], 1).astype(np.float32)))
    if not items and known is None:
        raise SystemExit(f"no images in {folder}/images/{where}: make a set with plumbline detector-set")
    return items


def decode(data):
    return cv2.cvtColor(cv2.imdecode(data, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)


class Crops:
    """`mosaics`: share of samples that are put together of four, so that more objects are seen.
    `zoom`: how large the images are drawn in the middle, as the exported network will see them."""

    def __init__(self, items, mosaics=0.0, zoom=1.0):
        self.items, self.mosaics, self.zoom = items, mosaics, zoom

    def side(self, rng):
        return int(rng.choice([256, 320, 320, 320, 384, 448]))

    def sample(self, rng, side):
        if rng.random() >= self.mosaics:
            return self.crop(rng, side)
        half = side // 2
        image, boxes = np.empty((side, side, 3), np.uint8), []
        for x, y in ((0, 0), (half, 0), (0, half), (half, half)):
            part, inside = self.crop(rng, half)
            image[y : y + half, x : x + half] = part
            boxes.append(inside + np.array([0, x, y, x, y], np.float32))
        return image, np.concatenate(boxes)

    def crop(self, rng, side):
        data, boxes = self.items[rng.integers(len(self.items))]
        image = decode(data)
        zoom = self.zoom * min(max(float(np.exp(rng.normal(0.05, 0.22))), 0.6), 1.8)
        zoom = max(zoom, side / image.shape[0] * 0.75)
        reach = 0.42 if side > 200 else 0.3
        image, boxes = self.cut(rng, image, boxes, side, zoom, reach)
        if rng.random() < 0.5:
            image, boxes = mirror(image, boxes)
        # The images are randomised already.
        return (recolor(rng, image) if rng.random() < 0.6 else image), boxes

    def cut(self, rng, image, boxes, side, zoom, reach):
        height, width = image.shape[:2]
        window = side / zoom
        if len(boxes) and rng.random() < 0.85:
            chosen = boxes[rng.integers(len(boxes))]
            middle = (chosen[1:3] + chosen[3:5]) / 2 + rng.uniform(-reach, reach, 2) * window
        else:
            middle = rng.uniform([0, 0], [width, height])
        low = middle - window / 2
        # Mostly on the image, as far as it is large enough.
        slack = 0.1 * window
        for axis, extent in enumerate((width, height)):
            lowest, highest = -slack, extent + slack - window
            low[axis] = np.clip(low[axis], min(lowest, highest), max(lowest, highest))
        matrix = np.array([[zoom, 0, -low[0] * zoom], [0, zoom, -low[1] * zoom]], np.float32)
        # Pixels count from their middle, boxes from the edge.
        matrix[:, 2] += 0.5 * zoom - 0.5
        source = image if zoom > 0.85 else cv2.GaussianBlur(image, (0, 0), 0.4 / zoom)
        out = cv2.warpAffine(source, matrix, (side, side), flags=cv2.INTER_LINEAR, borderValue=(0, 0, 0))
        moved = boxes.copy()
        moved[:, 1:] = (boxes[:, 1:] - np.tile(low, 2)) * zoom
        whole = (moved[:, 3:] - moved[:, 1:3]).prod(1)
        inside = moved.copy()
        inside[:, 1:] = inside[:, 1:].clip(0, side)
        size = inside[:, 3:] - inside[:, 1:3]
        keep = (size.prod(1) >= 0.35 * whole) & (size.min(1) >= 3)
        # What is cut to a sliver is covered: neither shown nor asked for.
        for row, box in zip(keep, inside):
            x0, y0, x1, y1 = np.round(box[1:]).astype(int)
            if not row and x1 > x0 and y1 > y0:
                out[max(y0 - 1, 0) : y1 + 1, max(x0 - 1, 0) : x1 + 1] = rng.integers(0, 255, 3)
        return out, inside[keep]


def mirror(image, boxes):
    """The mirror image, in which the left hand is a right one."""
    side = image.shape[1]
    boxes = boxes.copy()
    boxes[:, [1, 3]] = side - boxes[:, [3, 1]]
    left, right = boxes[:, 0] == LEFT_HAND, boxes[:, 0] == RIGHT_HAND
    boxes[left, 0], boxes[right, 0] = RIGHT_HAND, LEFT_HAND
    return np.ascontiguousarray(image[:, ::-1]), boxes


def recolor(rng, image):
    x = image
    if rng.random() < 0.25:
        x = cv2.GaussianBlur(x, (0, 0), rng.uniform(0.3, 1.1))
    elif rng.random() < 0.35:
        soft = cv2.GaussianBlur(x, (0, 0), rng.uniform(0.7, 1.5))
        strength = rng.uniform(0.2, 1.2)
        x = cv2.addWeighted(x, 1 + strength, soft, -strength, 0)
    if rng.random() < 0.7:
        hsv = cv2.cvtColor(x, cv2.COLOR_RGB2HSV)
        hue = (hsv[..., 0].astype(np.int16) + rng.integers(-5, 6)) % 180
        saturation = np.clip(hsv[..., 1] * rng.uniform(0.6, 1.35), 0, 255)
        hsv = np.stack([hue, saturation, hsv[..., 2]], -1).astype(np.uint8)
        x = cv2.cvtColor(hsv, cv2.COLOR_HSV2RGB)
    if rng.random() < 0.8:
        levels = np.arange(256) / 255
        tables = []
        gamma, gain, lift = np.exp(rng.normal(0, 0.22)), np.exp(rng.normal(0.02, 0.15)), rng.normal(0, 0.02)
        for _ in range(3):
            channel = gain * np.exp(rng.normal(0, 0.04))
            tables.append(np.clip((levels**gamma) * channel + lift, 0, 1) * 255)
        x = cv2.LUT(x, np.stack(tables, -1).astype(np.uint8)[None])
    if rng.random() < 0.4:
        noise = rng.normal(0, rng.uniform(1, 9), x.shape)
        x = np.clip(x + noise, 0, 255).astype(np.uint8)
    if rng.random() < 0.35:
        _, coded = cv2.imencode(".jpg", x, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(45, 95))])
        x = cv2.imdecode(coded, cv2.IMREAD_COLOR)
    return x
