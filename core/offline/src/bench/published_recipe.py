"""Trains an M3 the published way (64 ReLU, Adam 1e-3, batches of 16, 200 epochs) with scikit-learn.

Reads lines "u v x y z" from standard input; prints the library and the median seconds of a fit.
"""

import statistics
import sys
import time
import warnings

import numpy
import sklearn
from sklearn.neural_network import MLPRegressor

warnings.filterwarnings("ignore")  # 200 epochs do not converge, and are not meant to.
rows = numpy.loadtxt(sys.stdin)
inputs, outputs = rows[:, :2], rows[:, 2:]
inputs = (inputs - inputs.mean()) / inputs.std()
outputs = (outputs - outputs.mean()) / outputs.std()
seconds = []
for seed in range(3):
    network = MLPRegressor(
        hidden_layer_sizes=(64,), solver="adam", alpha=0.0, batch_size=16, learning_rate_init=1e-3,
        max_iter=200, tol=0.0, n_iter_no_change=10**6, random_state=seed,
    )
    start = time.perf_counter()
    network.fit(inputs, outputs)
    seconds.append(time.perf_counter() - start)
print(f"scikit-learn {sklearn.__version__};{statistics.median(seconds)}")
