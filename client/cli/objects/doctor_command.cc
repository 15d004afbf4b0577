#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/objects/commands.h"
#include "client/cli/objects/doctor_checks.h"
#include "client/teaching/turntable/look_alikes_text.h"
#include "files/base/json_object.h"
#include "program/text/printable_text.h"
#include "program/tls/pem_files.h"
#include "program/version.h"

namespace graspdb::client {
namespace {

const char* NameOf(Severity severity) {
  switch (severity) {
    case Severity::kAdvice:
      return "advice";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return "";
}

struct DoctorOptions {
  bool thresholds = false;
};

// Reads the state of a server and checks it.
class Doctor {
 public:
  Doctor(Client& client, const GlobalOptions& global, const DoctorOptions& options)
      : client_(client), global_(global), options_(options) {}

  // After an error the findings are those of the checks before it.
  absl::Status CheckAll();
  const Findings& findings() const { return out_; }

 private:
  absl::Status CheckState(const v1::CatalogStatus& status, absl::Time before);
  void CheckStreams();
  absl::Status CheckObjects();
  absl::Status CheckPoses(const v1::Object& object);
  absl::Status CheckProposals();
  // An open upload with views of the stable pose, or one in progress.
  absl::StatusOr<OpenUpload> OpenUploadOf(const std::string& stable_pose);

  Client& client_;
  const GlobalOptions& global_;
  const DoctorOptions& options_;
  Findings out_;
  std::vector<v1::Upload> uploads_;
  std::set<std::string> labels_;  // of all objects
  // Open uploads by the stable poses of their views; absent: not read yet.
  std::optional<std::map<std::string, std::string>> open_uploads_;
  std::string in_progress_;                      // the name of an upload; empty for none
  std::map<std::string, v1::StablePose> poses_;  // those with views
};

absl::StatusOr<OpenUpload> Doctor::OpenUploadOf(const std::string& stable_pose) {
  if (!open_uploads_) {
    open_uploads_.emplace();
    // Again, since an import may have begun meanwhile: it makes the stable poses first.
    ASSIGN_OR_RETURN(uploads_, client_.ListUploads());
    for (const v1::Upload& upload : uploads_) {
      if (upload.state() != v1::UPLOAD_STATE_OPEN) continue;
      if (IsInProgress(upload, absl::Now())) in_progress_ = upload.name();
      const auto views = client_.ListUploadViews(upload.name());
      // Committed or deleted meanwhile.
      if (absl::IsFailedPrecondition(views.status()) || absl::IsNotFound(views.status())) continue;
      if (!views.ok()) return views.status();
      for (const v1::UploadView& view : *views) {
        open_uploads_->emplace(view.name().substr(0, view.name().find("/views/")), upload.name());
      }
    }
  }
  const auto found = open_uploads_->find(stable_pose);
  if (found != open_uploads_->end()) return OpenUpload{found->second, true};
  return OpenUpload{in_progress_, false};
}

absl::Status Doctor::CheckPoses(const v1::Object& object) {
  ASSIGN_OR_RETURN(const auto poses, client_.ListStablePoses(object.name()));
  CheckObject(object, poses, &out_);
  for (const v1::StablePose& pose : poses) {
    ASSIGN_OR_RETURN(const auto views, client_.ListViews(pose.name()));
    absl::StatusOr<OpenUpload> upload = OpenUpload();
    if (views.empty()) {
      upload = OpenUploadOf(pose.name());
      if (!upload.ok()) return upload.status();
    } else {
      poses_[pose.name()] = pose;
    }
    CheckStablePose(pose, views.size(), *upload, &out_);
    CheckThreshold(pose, views, &out_);
  }
  return absl::OkStatus();
}

absl::Status Doctor::CheckObjects() {
  ASSIGN_OR_RETURN(const auto objects, client_.ListObjects());
  for (const v1::Object& object : objects) {
    labels_.insert(object.labels().begin(), object.labels().end());
    RETURN_IF_ERROR(CheckPoses(object));
  }
  ASSIGN_OR_RETURN(const auto alike, client_.FindLookAlikes(""));
  for (std::string& text : LookAlikesText(alike, /*nearly_too=*/false)) {
    out_.push_back({Severity::kWarning, "catalogue", std::move(text)});
  }
  return options_.thresholds ? CheckProposals() : absl::OkStatus();
}

absl::Status Doctor::CheckProposals() {
  ProgressLine progress;
  const auto found =
      client_.ProposeThresholds("", [&](const v1::ProposeThresholdsResponse& response) {
        if (Interrupted()) return absl::CancelledError("interrupted");
        if (response.view_count() > 0) {
          progress.Report(response.done_view_count(), response.view_count());
        }
        return absl::OkStatus();
      });
  if (!found.ok()) return found.status();
  for (const v1::ThresholdProposal& proposal : found->proposals()) {
    const auto pose = poses_.find(proposal.stable_pose());
    if (pose != poses_.end()) CheckProposal(pose->second, proposal, &out_);
  }
  return absl::OkStatus();
}

// `before` is the time of this machine before the call that got the status.
absl::Status Doctor::CheckState(const v1::CatalogStatus& status, absl::Time before) {
  const absl::Time now = absl::Now();
  CheckServer(status, kVersion, &out_);
  CheckBackups(status, &out_);
  CheckDisks(status, &out_);
  if (const std::string& cert = global_.security.cert; !cert.empty()) {
    ASSIGN_OR_RETURN(const auto end, CertificateEnd({"--cert", cert}));
    CheckCertificate("client", "--cert", end, now, &out_);
  }
  if (!status.has_server_state()) return absl::OkStatus();  // an older server
  const v1::ServerState& state = status.server_state();
  CheckClock(state, before, now, &out_);
  CheckWrites(state, &out_);
  CheckDatabaseFiles(state, &out_);
  CheckFiles(state, &out_);
  if (state.has_certificate_expire_time()) {
    CheckCertificate("server", "--tls-cert",
                     absl::FromUnixSeconds(state.certificate_expire_time().seconds()), now, &out_);
  }
  return absl::OkStatus();
}

// By trying one, that of the change stream.
void Doctor::CheckStreams() {
  const absl::Status watched =
      client_.WatchCatalog({}, [](const v1::WatchCatalogResponse& /*heartbeat*/) {
        return absl::CancelledError("the stream begins");
      });
  if (!absl::IsResourceExhausted(watched)) return;
  AddError(&out_, "server", "refuses streams: ", PrintableText(std::string(watched.message())));
}

absl::Status Doctor::CheckAll() {
  const absl::Time before = absl::Now();
  ASSIGN_OR_RETURN(const auto status, client_.GetCatalogStatus());
  RETURN_IF_ERROR(CheckState(status, before));
  CheckStreams();
  ASSIGN_OR_RETURN(uploads_, client_.ListUploads());
  RETURN_IF_ERROR(CheckObjects());
  ASSIGN_OR_RETURN(const auto cells, client_.ListCells());
  for (const v1::Cell& cell : cells) {
    CheckCell(cell, &out_);
    CheckCameraView(cell, &out_);
    CheckMinScore(cell, &out_);
    CheckLabels(cell, labels_, &out_);
  }
  for (const v1::Upload& upload : uploads_) CheckUpload(upload, absl::Now(), &out_);
  if (!status.has_server_state()) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto later, client_.GetCatalogStatus());
  CheckIndex(status, later, &out_);
  return absl::OkStatus();
}

absl::Status Print(const GlobalOptions& global, const Finding& finding) {
  if (!global.json) {
    std::printf("%-8s %s: %s\n", NameOf(finding.severity), finding.subject.c_str(),
                finding.text.c_str());
    return absl::OkStatus();
  }
  google::protobuf::Struct document;
  files::JsonObject(&document).Set(files::Json("severity", NameOf(finding.severity)),
                                   files::Json("subject", finding.subject),
                                   files::Json("text", finding.text));
  return PrintJson(document);
}

absl::Status RunDoctor(const GlobalOptions& global, const DoctorOptions& options) {
  Client client = Connect(global);
  Doctor doctor(client, global, options);
  absl::Status checked = doctor.CheckAll();
  std::size_t serious = 0;
  for (const Finding& finding : doctor.findings()) {
    RETURN_IF_ERROR(Print(global, finding));
    serious += finding.severity == Severity::kAdvice ? 0 : 1;
  }
  if (!checked.ok()) return checked;
  if (doctor.findings().empty() && !global.json) std::printf("no problems found\n");
  if (serious == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      serious == 1 ? "1 warning or error" : absl::StrCat(serious, " warnings and errors"),
      "; see above"));
}

}  // namespace

void AddDoctorCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(app, "doctor",
                                 "Check server, backups, certificates, catalogue, cells and "
                                 "uploads for mistakes, with advice");
  command->footer(
      "A line for each finding: advice, warning or error. With --json one document a line with\n"
      "severity, subject and text. Exit status: 0 without warnings and errors, 1 with some.");
  auto options = std::make_shared<DoctorOptions>();
  command->add_flag("--thresholds", options->thresholds,
                    "Also check the minimum scores of stable poses against their views, as "
                    "`objects thresholds` does; takes seconds for each object, and the role teach");
  command->callback(
      [=, &global] { *action = [=, &global] { return RunDoctor(global, *options); }; });
}

}  // namespace graspdb::client
