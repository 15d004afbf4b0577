#!/usr/bin/python3
"""fit_confidence.py REPORT.json...: the coefficients of
recognition/verification/confidence.cc, with their calibration.

The reports are those of `graspdb eval ... --min-score 1e-9 --out FOLDER`, of cases and of real
frames: with that score every answer is judged and none is rejected. Prints a logistic regression
with weights that are not negative (evidence against an answer never counts for it); the share that it
rejects; and the expected calibration error with each camera, each object and each real frame left
out in turn. Each case weighs the same; real frames as several, right and wrong answers the same. Needs python3-numpy
and python3-scipy.
"""
import json
import sys

import numpy as np
from scipy.optimize import minimize

FEATURES = ("scan", "contradicted", "residual", "unseen", "little")
RIDGE = 1e-5  # of the squared weights; keeps them finite where classes separate
BRICKS = {"b_lego_duplo", "f_lego_duplo", "d_lego_duplo"}  # one shape to a depth camera
FRAMES = 8  # weight of all real frames, in simulated cases


def features_of(evidence):
    return [evidence["features"][name] for name in FEATURES]


def samples(path):
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    for case in report.get("cases", []):
        for a in case["answers"]:
            named = a["stable_pose_answered"].split("/")[1] if a["stable_pose_answered"] else ""
            if not named or (not a["known"] and {named, a["object_query"]} <= BRICKS):
                continue
            right = a["known"] and a["pose_right" if a.get("posed", True) else "object_right"]
            yield case["name"], a["object_query"], right, a["score"], features_of(a["evidence"])
    for frame in report.get("frames", []):
        for d in frame["detections"]:
            if not d["pose_unknown"] and not d["again"]:
                yield "frame " + frame["name"], d["object"], d["right"], d["score"], features_of(
                    d["evidence"]
                )


def camera_of(name):
    """The camera of a case real-CAMERA..., or "ideal" or "frame"."""
    if name.startswith("frame "):
        return "frame"
    if not name.startswith("real-"):
        return "ideal"
    return "-".join(name.split("-")[1:3]) if name.startswith("real-k") else name.split("-")[1]


def weights_of(y, names):
    """Equal weights of all cases, and of the right and wrong answers in real frames."""
    out = np.zeros(len(y))
    cases = np.array(["frame" if n.startswith("frame ") else n for n in names])
    for case in set(cases):
        if case != "frame":
            out[cases == case] = 1 / np.sum(cases == case)
            continue
        for label in (0, 1):
            group = (cases == case) & (y == label)
            if group.any():
                out[group] = FRAMES / 2 / group.sum()
    return out / out.sum()


def fit(x, y, w):
    def loss(b):
        z = b[0] - x @ b[1:]
        return np.sum(w * np.logaddexp(0, np.where(y == 1, -z, z))) + RIDGE * np.sum(b[1:] ** 2)

    start = np.ones(x.shape[1] + 1)
    bounds = [(None, None)] + [(0, None)] * x.shape[1]
    return minimize(loss, start, bounds=bounds, method="L-BFGS-B").x


def predict(b, x):
    return 1 / (1 + np.exp(np.clip(x @ b[1:] - b[0], -500, 500)))


def calibration_error(p, y, w, bins=10):
    which = np.minimum((p * bins).astype(int), bins - 1)
    error = 0
    for k in range(bins):
        m = which == k
        if m.any() and w[m].sum() > 0:
            error += w[m].sum() * abs(np.average(y[m] - p[m], weights=w[m]))
    return error / w.sum()


def left_out(x, y, w, groups, chosen):
    """Predictions for each group of `chosen` by a fit without it."""
    p = np.full(len(y), np.nan)
    for group in chosen:
        m = groups == group
        p[m] = predict(fit(x[~m], y[~m], w[~m]), x[m])
    return p


def print_row(name, p, y, w):
    print(
        f"{name:32} {int(y.sum()):5d} right, {100 * np.mean(p[y == 1] < 0.5) if y.any() else 0:5.1f} % "
        f"rejected; {int((1 - y).sum()):5d} wrong, "
        f"{100 * np.mean(p[y == 0] >= 0.5) if (y == 0).any() else 0:5.1f} % accepted; "
        f"calibration error {calibration_error(p, y, w):.3f}"
    )


def main(paths):
    rows = [s for path in paths for s in samples(path)]
    names = np.array([r[0] for r in rows])
    objects = np.array([r[1] for r in rows])
    y = np.array([1.0 if r[2] else 0.0 for r in rows])
    today = np.array([r[3] for r in rows])
    x = np.array([r[4] for r in rows])
    cameras = np.array([camera_of(n) for n in names])
    w = weights_of(y, names)
    b = fit(x, y, w)
    print("offset %.2f, " % b[0] + ", ".join(f"{f} {v:.2f}" for f, v in zip(FEATURES, b[1:])))
    p = predict(b, x)
    for name in sorted(set(n if not n.startswith("frame ") else "frame" for n in names)):
        m = names == name if name != "frame" else cameras == "frame"
        print_row(name, p[m], y[m], w[m])
        print_row("  current coefficients", today[m], y[m], w[m])
    for what, groups in (("camera", cameras), ("object", objects), ("frame", names)):
        chosen = [g for g in sorted(set(groups)) if what != "frame" or g.startswith("frame ")]
        p = left_out(x, y, w, groups, chosen)
        for camera in sorted(set(cameras[~np.isnan(p)])):
            m = (cameras == camera) & ~np.isnan(p)
            print_row(f"each {what} left out: {camera}", p[m], y[m], w[m])


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1:])
