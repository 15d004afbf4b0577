// Who may make which call, and what is recorded about it: decided here for all services.
//
// An interceptor takes the caller's credentials and request id at the start of each call, and
// returns the id, or a new one, in the trailing metadata. gRPC's interceptors
// cannot end a call with a status, so that Handle() (server/calls/handle.h), which every handler
// runs in, takes the guard of its call and returns the guard's refusal instead of running the
// handler. Without a guard, Handle() refuses the call.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_builder.h>
#include <grpcpp/support/server_interceptor.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "program/connections/connection_watch.h"
#include "server/access/audit_log.h"
#include "server/access/identities.h"
#include "server/base/options.h"
#include "server/calls/call_metrics.h"
#include "server/calls/call_places.h"

namespace graspdb::server {

// The rules of one server, and where calls are recorded.
struct AccessRules {
  std::unique_ptr<IdentitiesFile> identities;    // null: every caller may make all calls
  std::unique_ptr<AuditLog> audit;               // null: no audit log
  std::function<std::int64_t()> revision;        // of the catalogue; for the audit log
  std::unique_ptr<CallMetrics> metrics;          // null: none
  std::unique_ptr<CallPlaces> places;            // null: any number of calls
  std::unique_ptr<ConnectionWatch> connections;  // null: calls may be abandoned
};

// Logs and audits a client whose certificate was refused in the TLS handshake, before any call. Its
// address is not known there.
void RecordRefusedHandshake(const AccessRules& rules, const absl::Status& refused);

// Opens the files of the options. Errors as those of IdentitiesFile and AuditLog.
absl::StatusOr<AccessRules> OpenAccessRules(const ServerOptions& options);

// Guards the calls of the server to be built. `rules` must outlive it.
void GuardCalls(const AccessRules& rules, grpc::ServerBuilder& builder);

// A name in a client's certificate, with its type as in v1::Identity.certificates.
struct CertificateName {
  std::string text;       // cut and sanitised for errors and logs
  bool is_exact = false;  // whether nothing was changed; else no identity has it
};

// The guard of one call, from its start to its end. Used by one thread at a time.
class CallGuard final : public grpc::experimental::Interceptor {
 public:
  CallGuard(const AccessRules& rules, grpc::experimental::ServerRpcInfo& call);
  ~CallGuard() override;
  CallGuard(const CallGuard&) = delete;
  CallGuard& operator=(const CallGuard&) = delete;

  // The guard of a call in progress; null for a call that has none.
  static CallGuard* Of(const grpc::ServerContextBase& context);

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override;

  // UNAUTHENTICATED for an unknown caller, PERMISSION_DENIED for one without the method's role.
  // By the identities of now: a later call may give another result.
  absl::Status Authorize();

  // After Authorize(): PERMISSION_DENIED if the caller may use another cell only.
  absl::Status AuthorizeRequest(const google::protobuf::Message& request) const;

  // After Authorize(): takes a place for the call, if it has none, or notes that the client uses
  // it. Errors as CallPlaces::Take().
  absl::Status TakePlace();

  // The client has sent another message of a stream.
  void NoteMessage() {
    if (place_) place_->NoteUse();
    if (rules_.connections != nullptr) rules_.connections->NoteMessage(context_.peer());
  }

  // CANCELLED if the stream had to leave its place to another one.
  absl::Status CheckPlace() const;

  // To be called in place of Record() when there is no place: counts each of these calls, but logs
  // and audits one a second.
  void RecordWithoutPlace(std::string_view method, const grpc::Status& status);

  // Adds the name of the request's resource, or another one, to the audit record.
  void NoteRequest(const google::protobuf::Message& request);
  void NoteResource(std::string_view name);

  // Adds ` key=value` to the log line of the call, or of the stream's frame.
  void NoteForLog(std::string_view key, std::string_view value);

  // To be called at the end of the call, or of a stream's frame, with its method and duration.
  // Counts it, and writes the audit record of a call that is refused or audited.
  void Record(std::string_view method, const grpc::Status& status, absl::Duration time) const;

  // Of the log line: the request id and the notes since the last call of this.
  std::string TakeLogFields();

  // The name of the caller's identity after Authorize(); empty if it is unknown.
  const std::string& identity() const { return identity_; }
  // Whether the caller has ROLE_OPERATE, after Authorize().
  bool operates() const { return operates_; }
  // The cell of the caller's identity; empty if it has none.
  const std::string& cell() const { return cell_; }
  // Null: there are none.
  CallMetrics* metrics() const { return rules_.metrics.get(); }

 private:
  absl::StatusOr<const v1::Identity*> Identify(const Identities& identities) const;
  void TakeCredentials(std::multimap<grpc::string_ref, grpc::string_ref>& metadata);
  void TakeRequestId(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata);
  void WatchConnection(grpc::experimental::InterceptorBatchMethods& methods);
  void Audit(const grpc::Status& status) const;
  void WriteAuditRecord(const grpc::Status& status) const;

  const AccessRules& rules_;
  grpc::ServerContextBase& context_;
  const google::protobuf::MethodDescriptor* const method_;  // null: not of a service of ours
  const bool is_reflection_;
  std::vector<std::string> tokens_;  // hashes; one in a correct call
  std::vector<CertificateName> certificates_;
  std::string identity_;  // for the audit log
  std::string cell_;      // the only one that it may use; empty: all
  bool operates_ = false;
  std::vector<std::string> resources_;
  std::string request_id_;
  std::string notes_;
  std::optional<CallPlaces::Place> place_;
  bool lacks_message_ = false;
};

}  // namespace graspdb::server
