#!/usr/bin/python3
"""reliability_diagram.py OUT.svg REPORT.json...: calibration of the score, for each camera.

The reports are those that fit_confidence.py reads. Draws one diagram for each camera and one for
the real frames: the share of right answers among those with a score, by the current confidence, and by
one fitted without that camera. A bar's height is the number of answers in its bin, as a
share of the largest. Prints both expected calibration errors. Needs python3-numpy, python3-scipy and
python3-matplotlib.
"""
import sys

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

import fit_confidence as fc

BINS = 10
TITLES = {
    "frame": "real frames",
    "kinect-v1": "Kinect v1, simulated",
    "kinect-v2": "Kinect v2, simulated",
    "realsense": "RealSense D400, simulated",
    "carmine": "Carmine, simulated",
    "ideal": "ideal, simulated",
}


def curve(p, y, w):
    """Mean score and share of right answers of each non-empty bin."""
    which = np.minimum((p * BINS).astype(int), BINS - 1)
    bins = [which == k for k in range(BINS)]
    return np.array(
        [(np.average(p[m], weights=w[m]), np.average(y[m], weights=w[m])) for m in bins if m.any()]
    )


def draw(axes, title, scores, y, w):
    """`scores`: by the label of each curve."""
    axes.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    for (label, p), color in zip(scores.items(), ("tab:blue", "tab:orange")):
        points = curve(p, y, w)
        error = fc.calibration_error(p, y, w, BINS)
        axes.plot(*points.T, marker="o", markersize=3, color=color, label=f"{label}: {error:.3f}")
    count, edges = np.histogram(scores["current"], bins=BINS, range=(0, 1))
    height = 0.25 * count / max(1, count.max())
    axes.bar(edges[:-1], height, width=1 / BINS, align="edge", color="0.9", zorder=0)
    axes.set_title(f"{title} ({len(y)} answers)", fontsize=9)
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal", xlabel="score", ylabel="share right")
    axes.legend(fontsize=7, loc=(0.4, 0.28), title="calibration error", title_fontsize=7)


def main(out, paths):
    rows = [s for path in paths for s in fc.samples(path)]
    names = [r[0] for r in rows]
    y = np.array([float(r[2]) for r in rows])
    today = np.array([r[3] for r in rows])
    x = np.array([r[4] for r in rows])
    w = fc.weights_of(y, names)
    cameras = np.array([fc.camera_of(n) for n in names])
    shown = [c for c in TITLES if (cameras == c).any()]
    without = fc.left_out(x, y, w, cameras, shown)
    figure, grid = plt.subplots(2, 3, figsize=(10, 7), layout="constrained")
    for axes in grid.flat[len(shown) :]:
        axes.remove()
    for axes, camera in zip(grid.flat, shown):
        m = cameras == camera
        # The share of right answers, without the weights of the fit.
        one = np.ones(m.sum())
        scores = {"current": today[m], "fitted without it": without[m]}
        draw(axes, TITLES[camera], scores, y[m], one)
        errors = ", ".join(f"{k} {fc.calibration_error(p, y[m], one):.3f}" for k, p in scores.items())
        print(f"{TITLES[camera]}: {int(y[m].sum())} of {m.sum()} right; {errors}")
    plt.rcParams.update({"svg.hashsalt": "graspdb", "svg.fonttype": "none"})
    figure.savefig(out, metadata={"Date": None})


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
