"""Tables of a report of `graspdb eval` in Markdown, and its poses as the BOP challenge takes them.

Format of the poses: https://bop.felk.cvut.cz/challenges/bop-challenge-2019, "How to participate". The BOP toolkit
reads it with load_bop_results, and cuts a file's name at "_" and "-": those of a case go.
"""
import csv
import io
import os

FRAMES = "frames"  # the case of frames of real cameras


def percent(value, count):
    return f"{100 * value:.1f}" if count else "–"


def case_rows(cases):
    rows = [["case", "queries", "object %", "pose %", "strictly %", "ambiguous %", "only listed %", "turn °", "shift mm",
             "unknown rejected %", "mean ms", "median ms", "95th percentile ms"]]
    for case in cases:
        s, t = case["summary"], case["time"]
        known, posed = s["known"], s.get("posed", s["known"])
        has_pose = posed > 0 and s["pose_right"] > 0
        rows.append([case["name"], int(known + s["unknown"])] +
                    [percent(s[key], count) for key, count in (("object_right", known), ("pose_right", posed),
                                                               ("strictly_right", posed), ("ambiguous", known),
                                                               ("listed", known))] +
                    [f"{s[key]:.2f}" if has_pose else "–" for key in ("mean_rotation_deg", "mean_translation_mm")] +
                    [percent(s["unknown_rejected"], s["unknown"])] +
                    [f"{t[key]:.0f}" if t["scenes"] else "–" for key in ("mean_ms", "median_ms", "p95_ms")])
    return rows


def descriptor_rows(descriptors):
    """How often the nearest of the object's own views was taken from a side more than 15 degrees off, and how often the
    nearest of all is another object's."""
    def cell(d):
        turned = d["false_recognition"].values()
        return f"{100 * sum(turned) / max(1, len(turned)):.2f} / {100 * d['object_wrong']:.2f}"
    cells = {(d["descriptor"], d["distance"]): cell(d) for d in descriptors}
    distances = list(dict.fromkeys(d["distance"] for d in descriptors))
    return [["turned over / another object %"] + distances] + [
        [name] + [cells.get((name, distance), "–") for distance in distances]
        for name in dict.fromkeys(d["descriptor"] for d in descriptors)]


def markdown(rows):
    lines = [[str(cell).replace("|", "\\|").replace("\n", " ") for cell in row] for row in rows]
    lines.insert(1, ["---"] + ["---:"] * (len(rows[0]) - 1))
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def bop_name(case):
    return f"graspdb_{case.replace('-', '').replace('_', '')}-test.csv"


def bop_csv(poses):
    """scene_id is 1, and R and t (mm) are T_camera_object. `poses` are (im_id, obj_id, score, pose, ms of the whole
    image)."""
    lines = ["scene_id,im_id,obj_id,score,R,t,time\n"]
    for image, part, score, pose, ms in poses:
        rotation, translation = (" ".join(f"{x:.9g}" for x in pose[key]) for key in ("rotation", "translation_mm"))
        lines.append(f"1,{int(image)},{int(part)},{score:.9g},{rotation},{translation},{ms / 1e3:.6f}\n")
    return "".join(lines)


def bop_objects(parts):
    """The numbers of the objects; `parts` are (case, object, stable pose), each case numbers its own from 1."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["case", "obj_id", "object", "stable_pose"])
    count = {}
    for case, name, stable_pose in parts:
        count[case] = count.get(case, 0) + 1
        writer.writerow([case, count[case], name, stable_pose])
    return out.getvalue()


def files_of_cases(report):
    files = {"cases.md": markdown(case_rows(report["cases"]))}
    if report.get("descriptors"):
        files["descriptors.md"] = markdown(descriptor_rows(report["descriptors"]))
    cases = [case for case in report["cases"] if "parts" in case]  # older reports have no poses
    for case in cases:
        files[bop_name(case["name"])] = bop_csv((a["scene"], a["part_answered"], a["score"], a["camera_object"], a["ms"])
                                                for a in case["answers"] if "part_answered" in a)
    if cases:
        files["bop_objects.csv"] = bop_objects((case["name"], part["object"], part["stable_pose"])
                                               for case in cases for part in case["parts"])
    return files


def files_of_frames(report):
    """im_id is the position of the frame, from 0, and the pose that of the mesh as its file has it."""
    numbers = {name: i + 1 for i, name in enumerate(report["objects"])}
    return {"stages.md": markdown(report["stages"]),
            bop_name(FRAMES): bop_csv((i, numbers[d["object"]], d["score"], d["camera_mesh"], frame["ms"])
                                      for i, frame in enumerate(report["frames"]) for d in frame["detections"]),
            "bop_objects.csv": bop_objects((FRAMES, name, "") for name in report["objects"])}


def write(folder, name, text):
    path = os.path.join(folder, name)
    with open(path + ".tmp", "w", encoding="utf-8", newline="") as file:
        file.write(text)
    os.replace(path + ".tmp", path)


def is_report(document):
    return isinstance(document, dict) and ("cases" in document or {"objects", "stages", "frames"} <= document.keys())


def write_tables(folder, report):
    for name, text in (files_of_cases if "cases" in report else files_of_frames)(report).items():
        write(folder, name, text)
