// What `graspdb doctor` looks for and reports. Pure functions; those of a server beside its
// catalogue are in doctor_server_checks.cc.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/cell.pb.h"
#include "graspdb/v1/thresholds.pb.h"
#include "graspdb/v1/upload_service.pb.h"

namespace graspdb::client {

enum class Severity { kAdvice, kWarning, kError };

// Something to look at.
struct Finding {
  Severity severity = Severity::kAdvice;
  std::string subject;  // resource name, "server" or "client"
  std::string text;     // what is wrong, and what to do
};
using Findings = std::vector<Finding>;

// The text is that of the parts, one behind the other, as of absl::StrCat.
template <typename... Parts>
void AddFinding(Findings* out, Severity severity, std::string_view subject, const Parts&... parts) {
  out->push_back({severity, std::string(subject), absl::StrCat(parts...)});
}
template <typename... Parts>
void AddAdvice(Findings* out, std::string_view subject, const Parts&... parts) {
  AddFinding(out, Severity::kAdvice, subject, parts...);
}
template <typename... Parts>
void AddWarning(Findings* out, std::string_view subject, const Parts&... parts) {
  AddFinding(out, Severity::kWarning, subject, parts...);
}
template <typename... Parts>
void AddError(Findings* out, std::string_view subject, const Parts&... parts) {
  AddFinding(out, Severity::kError, subject, parts...);
}

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

// Backups that fail, are missing or old.
void CheckBackups(const v1::CatalogStatus& status, Findings* out);

// Space on the disks of the database and of the backups.
void CheckDisks(const v1::CatalogStatus& status, Findings* out);

// Changes that the server rejects since its disk fails or is full.
void CheckWrites(const v1::ServerState& state, Findings* out);

// Files of the database that are missing or damaged.
void CheckDatabaseFiles(const v1::ServerState& state, Findings* out);

// Files of the settings that cannot be used, and audit records that are lost.
void CheckFiles(const v1::ServerState& state, Findings* out);

// The certificate of that flag, which expires at `end`. `subject` is "server" or "client".
void CheckCertificate(std::string_view subject, std::string_view flag, absl::Time end,
                      absl::Time now, Findings* out);

// The server's clock against this machine's, whose times are those before and after the call.
void CheckClock(const v1::ServerState& state, absl::Time before, absl::Time after, Findings* out);

// Whether the index has the changes of the catalogue: those of the status `first` in the status
// `later`, as a change of the moment is not in it yet.
void CheckIndex(const v1::CatalogStatus& first, const v1::CatalogStatus& later, Findings* out);

}  // namespace graspdb::client
