"""eval_report_test.py PROGRAM: graspdb-eval-report on reports that are written by hand."""
import importlib.machinery
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(PROGRAM))
loader = importlib.machinery.SourceFileLoader("eval_report", PROGRAM)
eval_report = importlib.util.module_from_spec(importlib.util.spec_from_loader("eval_report", loader))
loader.exec_module(eval_report)


def answer(query, answered, score, known=True, right=True, add_s_share=0.01):
    return {"object_query": query, "object_answered": answered, "known": known, "score": score,
            "stable_pose_answered": f"objects/{answered}/stablePoses/p" if answered else "",
            "object_right": right, "pose_right": right, "add_s_share": add_s_share if right else None}


# Two right, one taken for another, one without an answer, one that was not taught and is rejected.
ANSWERS = [answer("cup", "cup", 0.95), answer("can", "can", 0.97), answer("cup", "can", 0.62, right=False),
           answer("can", "", 0, right=False), answer("bolt", "", 0, known=False, right=True)]


def case(name="hidden-20", answers=ANSWERS):
    numbers = dict.fromkeys(["object_right", "pose_right", "strictly_right", "ambiguous", "listed", "mean_rotation_deg",
                             "mean_translation_mm", "unknown_rejected"], 0.5)
    objects = [{"object": o, "known": o != "bolt", "falsely_named": 0.5, "pose_wrong": 0.5,
                "mean_rotation_deg": 1 if o == "cup" else None, "mean_translation_mm": 2 if o == "cup" else None}
               for o in sorted({a["object_query"] for a in answers})]
    view = {"object": "cup", "descriptor_distance": 0.1, "verification_score": None, "chosen": True}
    pixels = {"u": [1, 2], "v": [3, 4]}
    return {"name": name, "description": "A Kinect", "answers": answers, "objects": objects,
            "summary": dict(numbers, known=4, unknown=1),
            "time": dict.fromkeys(["scenes", "mean_ms", "median_ms", "p95_ms", "longest_ms"], 5),
            "first_matches": {"scene": 2, "stable_pose_query": "cup", "answered": True, "views": [view]},
            "drawings": [{"title": "Query 2", "scan": pixels, "truth": pixels}]}


class Curves(unittest.TestCase):
    def test_recall_grows_with_the_allowed_error(self):
        recall = eval_report.recall_over_add_s(ANSWERS)
        self.assertEqual((recall[0][1], recall[-1][1]), (0, 0.5))
        self.assertEqual(eval_report.recall_over_add_s(ANSWERS[4:]), [])

    def test_answers_without_a_true_pose_are_judged_by_the_object(self):
        unposed = [dict(a, posed=False, pose_right=False, add_s_share=None) for a in ANSWERS]
        self.assertEqual(eval_report.recall_over_add_s(unposed), [])
        self.assertEqual(eval_report.recall_over_add_s(ANSWERS + unposed), eval_report.recall_over_add_s(ANSWERS))
        self.assertEqual(eval_report.reliability(unposed), {6: [False], 9: [True, True]})
        self.assertEqual(eval_report.over_score(unposed), eval_report.over_score(ANSWERS))
        without_poses = case()
        without_poses["summary"].update(posed=0, pose_right=0, strictly_right=0)
        self.assertEqual(eval_report.case_rows([without_poses])[1][1:5], [5, "50.0", "–", "–"])

    def test_precision_grows_and_recall_falls_with_the_minimum_score(self):
        precision, recall = eval_report.over_score(ANSWERS)
        self.assertAlmostEqual(precision[0][1], 2 / 3)
        self.assertEqual(precision[-1], (0.96, 1))
        self.assertEqual(recall[-1], (1, 0))

    def test_reliability_counts_by_tenths_of_the_score(self):
        self.assertEqual(eval_report.reliability(ANSWERS), {6: [False], 9: [True, True]})

    def test_confusions_count_queries_without_an_answer(self):
        self.assertEqual(eval_report.confusions(ANSWERS)["can", ""], 1)


def made(report):
    """The files that the program makes of a report, with their texts; of figures the names."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "report.json"), "w", encoding="utf-8") as file:
            json.dump(report, file)
        subprocess.run([PROGRAM, folder], check=True)
        out = {}
        for name in os.listdir(folder):
            if os.path.isdir(os.path.join(folder, name)):
                out[name] = sorted(os.listdir(os.path.join(folder, name)))
                continue
            with open(os.path.join(folder, name), encoding="utf-8", newline="") as file:
                out[name] = file.read()
        return out


POSE = {"rotation": [0, -1, 0, -1, 0, 0, 0, 0, -1], "translation_mm": [100, -200, 950.0000000004]}


class Tables(unittest.TestCase):
    def test_answered_poses_are_in_the_format_of_bop(self):
        answered = dict(ANSWERS[0], scene=7, ms=40, part_answered=2, camera_object=POSE)
        parts = [{"object": "cup, small", "stable_pose": "p"}, {"object": "can", "stable_pose": "q"}]
        files = made({"command": "", "cases": [dict(case(answers=[answered, dict(ANSWERS[3], ms=40)]), parts=parts)]})
        self.assertEqual(files["graspdb_hidden20-test.csv"],
                         "scene_id,im_id,obj_id,score,R,t,time\n1,7,2,0.95,0 -1 0 -1 0 0 0 0 -1,100 -200 950,0.040000\n")
        self.assertEqual(files["bop_objects.csv"],
                         'case,obj_id,object,stable_pose\nhidden-20,1,"cup, small",p\nhidden-20,2,can,q\n')

    def test_frames_have_poses_of_the_mesh_and_stages(self):
        detection = {"object": "nut", "score": 0.75, "camera_mesh": POSE}
        frames = [{"ms": 30, "detections": []}, {"ms": 40, "detections": [detection]}]
        files = made({"command": "", "objects": ["bolt", "nut"], "frames": frames, "stages": [["true poses", "all"], ["kept", "1"]]})
        self.assertTrue(files["graspdb_frames-test.csv"].endswith("\n1,1,2,0.75,0 -1 0 -1 0 0 0 0 -1,100 -200 950,0.040000\n"))
        self.assertEqual(files["bop_objects.csv"], "case,obj_id,object,stable_pose\nframes,1,bolt,\nframes,2,nut,\n")
        self.assertEqual(files["stages.md"], "| true poses | all |\n| --- | ---: |\n| kept | 1 |\n")
        self.assertNotIn("report.html", files)

    def test_cases_and_descriptors_are_tables_of_markdown(self):
        descriptors = [{"descriptor": d, "distance": "L1", "query_count": 96, "object_wrong": 0.125,
                        "false_recognition": {"cup": 0.5, "can": 0.25}} for d in ("vfh263", "mvfh300")]
        files = made({"command": "", "descriptors": descriptors, "cases": [case("a|b")]})
        self.assertIn("\n| a\\|b | 5 | 50.0 |", files["cases.md"])
        self.assertEqual(files["descriptors.md"].splitlines()[2:], ["| vfh263 | 37.50 / 12.50 |", "| mvfh300 | 37.50 / 12.50 |"])

    def test_without_matplotlib_there_are_tables(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "report.json"), "w", encoding="utf-8") as file:
                json.dump({"command": "", "cases": [case()]}, file)
            with open(os.path.join(folder, "matplotlib.py"), "w", encoding="utf-8") as file:
                file.write("raise ImportError('no matplotlib')")
            run = subprocess.run([PROGRAM, folder], capture_output=True, text=True, check=False,
                                 env=dict(os.environ, PYTHONPATH=folder))
            self.assertEqual(run.returncode, 1)
            self.assertIn("install python3-matplotlib", run.stderr)
            self.assertTrue(os.path.exists(os.path.join(folder, "cases.md")))


class Page(unittest.TestCase):
    def page(self, report):
        files = made(report)
        self.figures = files["figures"]
        return files["report.html"]

    def test_shows_cases_and_descriptors_and_is_the_same_each_time(self):
        descriptor = {"descriptor": "MVFH-300", "distance": "L1", "query_count": 96, "object_wrong": 0.125,
                      "false_recognition": {"cup": 0.5, "can": 0.25}}
        report = {"command": "graspdb eval", "descriptors": [descriptor], "cases": [case(), case("empty", [])]}
        page = self.page(report)
        self.assertIn('id="case-hidden-20"', page)
        self.assertIn("<td>MVFH-300</td><td>L1</td><td>37.5</td><td>12.5</td>", page)
        self.assertIn("There were no queries", page)
        self.assertIn("hidden-20-mean-absolute-rotation-error-for-each-object.svg", self.figures)
        self.assertEqual(page, self.page(report))

    def test_escapes_names_and_loads_nothing(self):
        page = self.page({"command": "'<script>'", "cases": [case("case <i>&\"", [answer("<b>&\"", "<b>&\"", 1)])]})
        for unwanted in ("<script", "<i>&", "<b>&", "src=", "@import"):
            self.assertNotIn(unwanted, page)

    def test_lists_pairs_where_a_matrix_would_be_too_large(self):
        many = [answer(f"part-{i}", f"part-{i}", 1) for i in range(40)]
        page = self.page({"command": "", "cases": [case("many", ANSWERS + many)]})
        self.assertIn("<td>cup</td><td>can</td><td>1</td>", page)
        self.assertNotIn("<td>bolt</td><td>(none)</td>", page)

    def test_a_folder_without_a_report_is_an_error_with_advice(self):
        with tempfile.TemporaryDirectory() as folder:
            run = subprocess.run([PROGRAM, folder], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 1)
        self.assertIn("name the folder of graspdb eval --out", run.stderr)


unittest.main(verbosity=2)
