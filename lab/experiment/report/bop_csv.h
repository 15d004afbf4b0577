// Answers in the format in which the BOP challenge takes results.
//
// The format: https://bop.felk.cvut.cz/challenges/bop-challenge-2019, "How to participate"; the
// BOP toolkit reads it with load_bop_results.
#pragma once

#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/real_frames.h"

namespace graspdb::lab {

// "graspdb_hidden20-test.csv" for the case "hidden-20": METHOD_DATASET-SPLIT.csv. The toolkit cuts
// the name at '_' and '-', so that the case's own ones go.
std::string BopFileName(const std::string& case_name);

// Whether it may be the name of such a file, of any case.
bool IsBopFileName(const std::string& name);

// "scene_id,im_id,obj_id,score,R,t,time" and a line for each answer that names a stable pose.
// scene_id is 1, im_id the number of the query. R (row by row) and t (mm) are T_camera_object,
// camera: x right, y down, z forward; object: the frame of the workpiece's mesh as it rests. time:
// seconds for the whole image, so that all its lines have the same.
std::string BopCsv(const CaseResult& result);

// "case,obj_id,object,stable_pose"; every case numbers its parts from 1. The lines of one case,
// after BopObjectsHeader().
std::string BopObjectsHeader();
std::string BopObjects(const CaseResult& result);

// The same of frames of real cameras, whose case is kBopFrames. im_id is the position of the frame
// in `results`, from 0, and obj_id that of the object in `object_ids`, from 1. R and t are
// T_camera_mesh, of the mesh as its file has it.
inline constexpr char kBopFrames[] = "frames";
std::string BopCsv(const std::vector<FrameResult>& results,
                   const std::vector<std::string>& object_ids);
std::string BopObjects(const std::vector<std::string>& object_ids);

}  // namespace graspdb::lab
