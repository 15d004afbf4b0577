"""eval_report_test.py PROGRAM: graspdb-eval-report on a report that is written by hand."""
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
        self.assertIn("<td>5</td><td>50.0</td><td>–</td><td>–</td>", eval_report.case_table([without_poses]))

    def test_precision_grows_and_recall_falls_with_the_minimum_score(self):
        precision, recall = eval_report.over_score(ANSWERS)
        self.assertAlmostEqual(precision[0][1], 2 / 3)
        self.assertEqual(precision[-1], (0.96, 1))
        self.assertEqual(recall[-1], (1, 0))

    def test_reliability_counts_by_tenths_of_the_score(self):
        self.assertEqual(eval_report.reliability(ANSWERS), {6: [False], 9: [True, True]})

    def test_confusions_count_queries_without_an_answer(self):
        self.assertEqual(eval_report.confusions(ANSWERS)["can", ""], 1)


class Page(unittest.TestCase):
    def page(self, report):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "report.json"), "w", encoding="utf-8") as file:
                json.dump(report, file)
            subprocess.run([PROGRAM, folder], check=True)
            self.figures = sorted(os.listdir(os.path.join(folder, "figures")))
            with open(os.path.join(folder, "report.html"), encoding="utf-8") as file:
                return file.read()

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
