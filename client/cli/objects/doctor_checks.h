// What `graspdb doctor` looks for. Pure functions.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/time/time.h"
#include "client/cli/objects/doctor_finding.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/cell.pb.h"
#include "graspdb/v1/thresholds.pb.h"
#include "graspdb/v1/upload_service.pb.h"

namespace graspdb::client {

// Whether the camera of a cell sees its region, as far as its pose is known.
void CheckCameraView(const v1::Cell& cell, Findings* out);

// Whether the settings of a cell let something be recognised.
void CheckMinScore(const v1::Cell& cell, Findings* out);

// The server: version, records that are left out, memory.
void CheckServer(const v1::CatalogStatus& status, std::string_view client_version, Findings* out);

// An object with its stable poses.
void CheckObject(const v1::Object& object, const std::vector<v1::StablePose>& stable_poses,
                 Findings* out);

// An upload that is not committed, for a stable pose without views.
struct OpenUpload {
  std::string name = {};   // empty: there is none
  bool has_views = false;  // of the stable pose; else it is in progress, and may get some
};

// A stable pose with its number of views.
void CheckStablePose(const v1::StablePose& stable_pose, std::size_t views,
                     const OpenUpload& open_upload, Findings* out);

// Whether the upload is open, not all of its views were sent yet, and it is not forgotten.
bool IsInProgress(const v1::Upload& upload, absl::Time now);

// Whether views are newer than the minimum score of the stable pose, which takes no account of
// them then.
void CheckThreshold(const v1::StablePose& stable_pose, const std::vector<v1::View>& views,
                    Findings* out);

// Whether the minimum score of a stable pose is the one that its views call for.
void CheckProposal(const v1::StablePose& stable_pose, const v1::ThresholdProposal& proposal,
                   Findings* out);

// Calibration, region and workspace.
void CheckCell(const v1::Cell& cell, Findings* out);

// A cell whose labels no object has; `labels` are those of all objects.
void CheckLabels(const v1::Cell& cell, const std::set<std::string>& labels, Findings* out);

// Uploads that seem to be forgotten.
void CheckUpload(const v1::Upload& upload, absl::Time now, Findings* out);

}  // namespace graspdb::client
