"""Median milliseconds of ultralytics' predict on one image: MODEL IMAGE ROUNDS."""

import statistics
import sys
import time

try:
    import cv2
    import onnxruntime  # noqa: F401
    import ultralytics
except ImportError as error:
    sys.exit(f"{error}: pip install ultralytics onnxruntime in this Python")

model, image, rounds = sys.argv[1], cv2.imread(sys.argv[2]), int(sys.argv[3])
network = ultralytics.YOLO(model, task="detect")
times = []
for round in range(rounds + 5):
    begun = time.perf_counter()
    network.predict(image, conf=0.25, iou=0.7, device="cpu", verbose=False)
    if round >= 5:
        times.append(1e3 * (time.perf_counter() - begun))
print(statistics.median(times))
