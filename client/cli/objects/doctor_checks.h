// What `graspdb doctor` looks for. Pure functions.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/time/time.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/cell.pb.h"
#include "graspdb/v1/upload_service.pb.h"

namespace graspdb::client {

enum class Severity { kAdvice, kWarning, kError };

// Something to look at.
struct Finding {
  Severity severity = Severity::kAdvice;
  std::string subject;  // resource name, or "server"
  std::string text;     // what is wrong, and what to do
};
using Findings = std::vector<Finding>;

// The server: version, records that are left out, memory.
void CheckServer(const v1::CatalogStatus& status, std::string_view client_version, Findings* out);

// An object with its stable poses.
void CheckObject(const v1::Object& object, const std::vector<v1::StablePose>& stable_poses,
                 Findings* out);

// A stable pose with its number of views.
void CheckStablePose(const v1::StablePose& stable_pose, std::size_t views, Findings* out);

// Calibration, region and workspace.
void CheckCell(const v1::Cell& cell, Findings* out);

// Uploads that seem to be forgotten.
void CheckUpload(const v1::Upload& upload, absl::Time now, Findings* out);

}  // namespace graspdb::client
