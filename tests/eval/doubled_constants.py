#!/usr/bin/python3
"""doubled_constants.py [NAME...]: what happens when a constant of the matching is doubled.

Takes each `constexpr` number of recognition/matching/*.cc and recognition/verification/*.cc (or those
named), doubles it in a copy of the sources, builds graspdb-lab there, and runs two evaluations: the
frames of real cameras in ../shared/data/real_frames, and the simulated cases of objects that touch
and of objects 40 % hidden. A share or score between 0.5 and 1 is moved twice as far from 1 instead.
Prints a row of Markdown for each, beside one without a change. Takes two minutes for each constant.
The copy is GRASPDB_DOUBLED (default /tmp/graspdb-doubled) and is kept for the next run.
"""
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path(os.environ.get("GRASPDB_SHARED_DATA", ROOT.parent / "shared/data"))
COPY = pathlib.Path(os.environ.get("GRASPDB_DOUBLED", "/tmp/graspdb-doubled"))
NUMBER = re.compile(r"^(?:inline )?constexpr (?:double|float|int|std::size_t) (k\w+) = ([^;]+);", re.M)
# Conversions, fitted coefficients (tests/eval/fit_confidence.py), limits that no evaluation reaches.
NO_CHOICE = {"kOffset", "kScan", "kContradicted", "kResidual", "kUnseen", "kLittle", "kNegligibleTurn",
             "kNegligibleShift", "kNegligibleMoveM", "kFullPoints", "kPitch", "kFar", "kUnlimitedM", "kFarthestPixel", "kMaxPixelsPerSide", "kMaxCellsPerSide",
             "kScreenedAtOnce", "kBorders"}
MESHES = ("adjustable_wrench,b_lego_duplo,b_toy_airplane,banana,extra_large_clamp,foam_brick,hammer,"
          "medium_clamp,nine_hole_peg_test,padlock,pudding_box,wood_block")
CASES = "touching,hidden-40"


def constants(root, names):
    """(file, name, expression) of each constant, in the order of the files."""
    for folder in ("matching", "verification"):
        for path in sorted((root / "recognition" / folder).glob("*.cc")):
            for name, value in NUMBER.findall(path.read_text()):
                if name in NO_CHOICE or (names and name not in names):
                    continue
                yield path.relative_to(root), name, value


def doubled(value):
    plain = value.rstrip("F").replace("'", "")
    try:
        number = float(plain)
    except ValueError:
        return f"2 * ({value})"
    if 0.5 <= number < 1:
        return f"1 - 2 * (1 - {value})"
    return f"2 * {value}"


def run(*words, **options):
    return subprocess.run(words, check=True, capture_output=True, text=True, cwd=COPY, **options).stdout


def build():
    run("cmake", "--build", "build/doubled", "--target", "graspdb-lab")


def figures():
    """Found and wrong real objects, their median time, and the shares of right simulated ones."""
    lab = COPY / "build/doubled/bin/graspdb-lab"
    out = COPY / "build/report"
    run(lab, "eval", DATA / "real_frames", "--out", out / "real")
    real = json.loads((out / "real/report.json").read_text())
    meshes = [DATA / "ycb_meshes" / f"{name}.ply" for name in MESHES.split(",")]
    run(lab, "eval", *meshes, "--case", CASES, "--trials", "4", "--seed", "2", "--out", out / "cases")
    cases = json.loads((out / "cases/report.json").read_text())
    return real, cases


def row(name, value, real, cases):
    found = sum(item["found"] for frame in real["frames"] for item in frame["objects"])
    wrong = sum(not item["right"] for frame in real["frames"] for item in frame["detections"])
    times = sorted(frame["ms"] for frame in real["frames"])
    shares = " | ".join(f"{100 * case['summary']['strictly_right']:.1f}" for case in cases["cases"])
    return f"| {name} | {value} | {found} | {wrong} | {times[len(times) // 2]:.0f} | {shares} |"


def main():
    os.nice(10)
    if not COPY.exists():
        subprocess.run(["git", "clone", "-q", ROOT, COPY], check=True)
    run("cmake", "--preset", "release", "-B", "build/doubled", "-DGRASPDB_BUILD_TESTS=OFF")
    build()
    print("| constant | value | real: right | wrong | median ms | touching % | hidden-40 % |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: |")
    print(row("as it is", "", *figures()), flush=True)
    for path, name, value in constants(COPY, set(sys.argv[1:])):
        file = COPY / path
        before = file.read_text()
        file.write_text(before.replace(f"{name} = {value};", f"{name} = {doubled(value)};"))
        try:
            build()
            print(row(name, f"{value} -> {doubled(value)}", *figures()), flush=True)
        except subprocess.CalledProcessError as error:
            print(f"| {name} | {doubled(value)} | {error} |", flush=True)
        finally:
            file.write_text(before)


if __name__ == "__main__":
    main()
