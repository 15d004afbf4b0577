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

// The server: version, records that are left out, memory.
void CheckServer(const v1::CatalogStatus& status, std::string_view client_version, Findings* out);

// An object with its stable poses.
void CheckObject(const v1::Object& object, const std::vector<v1::StablePose>& stable_poses,
                 Findings* out);

// A stable pose with its number of views, and the name of an upload with views of it that is not
// committed, or "".
void CheckStablePose(const v1::StablePose& stable_pose, std::size_t views,
                     const std::string& open_upload, Findings* out);

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
