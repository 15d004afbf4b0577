#include "server/calls/call_guard.h"

#include <google/protobuf/util/time_util.h>
#include <grpcpp/security/auth_context.h>
#include <spdlog/spdlog.h>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "program/connections/peer_address.h"
#include "program/log/log_field.h"
#include "program/log/request_id.h"
#include "server/access/identities.h"
#include "server/access/method_role.h"
#include "server/base/errors.h"
#include "server/requests/request_limits.h"
#include "server/requests/request_names.h"

namespace graspdb::server {
namespace {

constexpr std::string_view kAuthorization = "authorization";
constexpr absl::string_view kBearer = "Bearer ";
constexpr absl::string_view kReflection = "/grpc.reflection.";

// Names that are read from a certificate; real ones have one to three.
constexpr std::size_t kMaxCertificateNames = 16;

// Resources in an audit record.
constexpr std::size_t kMaxResources = 16;

// Guards by the contexts of their calls, which gRPC does not link.
class Guards {
 public:
  void Add(const grpc::ServerContextBase& context, CallGuard* guard) {
    absl::MutexLock lock(&mutex_);
    guards_[&context] = guard;
  }
  void Remove(const grpc::ServerContextBase& context) {
    absl::MutexLock lock(&mutex_);
    guards_.erase(&context);
  }
  CallGuard* Find(const grpc::ServerContextBase& context) {
    absl::MutexLock lock(&mutex_);
    const auto found = guards_.find(&context);
    return found == guards_.end() ? nullptr : found->second;
  }

 private:
  absl::Mutex mutex_;
  std::unordered_map<const grpc::ServerContextBase*, CallGuard*> guards_ ABSL_GUARDED_BY(mutex_);
};

Guards& AllGuards() {
  static auto* const guards = new Guards;  // calls may end after static objects
  return *guards;
}

class GuardFactory : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  explicit GuardFactory(const AccessRules& rules) : rules_(rules) {}
  grpc::experimental::Interceptor* CreateServerInterceptor(
      grpc::experimental::ServerRpcInfo* call) override {
    return new CallGuard(rules_, *call);
  }

 private:
  const AccessRules& rules_;
};

// The names in the client's certificate, in the order in which they are looked up; empty without a
// certificate that was verified.
std::vector<CertificateName> CertificateNames(const grpc::ServerContextBase& context) {
  std::vector<CertificateName> out;
  const std::shared_ptr<const grpc::AuthContext> peer = context.auth_context();
  if (peer == nullptr || !peer->IsPeerAuthenticated()) return out;
  const auto add = [&](const char* type, const char* property) {
    for (const grpc::string_ref& name : peer->FindPropertyValues(property)) {
      if (out.size() == kMaxCertificateNames) return;
      const std::string full = absl::StrCat(type, absl::string_view(name.data(), name.size()));
      std::string text = BoundedText(full, kMaxStringBytes);
      const bool is_exact = text == full;
      out.push_back({std::move(text), is_exact});
    }
  };
  add("uri:", GRPC_PEER_URI_PROPERTY_NAME);
  add("dns:", GRPC_PEER_DNS_PROPERTY_NAME);
  add("cn:", GRPC_X509_CN_PROPERTY_NAME);
  return out;
}

// TimeUtil::GetCurrentTime() has whole seconds, too few to order calls or to find them in the log.
google::protobuf::Timestamp AuditTime() {
  return google::protobuf::util::TimeUtil::MillisecondsToTimestamp(absl::ToUnixMillis(absl::Now()));
}

}  // namespace

absl::StatusOr<AccessRules> OpenAccessRules(const ServerOptions& options) {
  AccessRules out;
  if (!options.identities.empty()) {
    ASSIGN_OR_RETURN(out.identities, IdentitiesFile::Open(options.identities));
  }
  if (!options.audit_log.empty()) {
    ASSIGN_OR_RETURN(
        out.audit,
        AuditLog::Open(options.audit_log, static_cast<std::size_t>(options.audit_log_mib) << 20U));
  }
  if (!options.metrics.listen.empty()) out.metrics = std::make_unique<CallMetrics>();
  return out;
}

void GuardCalls(const AccessRules& rules, grpc::ServerBuilder& builder) {
  std::vector<std::unique_ptr<grpc::experimental::ServerInterceptorFactoryInterface>> factories;
  factories.push_back(std::make_unique<GuardFactory>(rules));
  builder.experimental().SetInterceptorCreators(std::move(factories));
}

CallGuard::CallGuard(const AccessRules& rules, grpc::experimental::ServerRpcInfo& call)
    : rules_(rules),
      context_(*call.server_context()),
      method_(FindMethod(call.method())),
      is_reflection_(absl::StartsWith(call.method(), kReflection)) {
  AllGuards().Add(context_, this);
}

CallGuard::~CallGuard() { AllGuards().Remove(context_); }

CallGuard* CallGuard::Of(const grpc::ServerContextBase& context) {
  return AllGuards().Find(context);
}

void CallGuard::Intercept(grpc::experimental::InterceptorBatchMethods* methods) {
  using grpc::experimental::InterceptionHookPoints;
  if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_INITIAL_METADATA)) {
    TakeCredentials(*methods->GetRecvInitialMetadata());
    TakeRequestId(*methods->GetRecvInitialMetadata());
    if (is_reflection_ && rules_.places != nullptr) {
      place_.emplace(rules_.places->TakeForReflection(context_));
    }
  }
  if (place_ && methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS)) {
    place_->NoteEnd();
  }
  if (rules_.connections != nullptr) WatchConnection(*methods);
  methods->Proceed();
}

void CallGuard::WatchConnection(grpc::experimental::InterceptorBatchMethods& methods) {
  using grpc::experimental::InterceptionHookPoints;
  if (methods.QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_INITIAL_METADATA)) {
    rules_.connections->NoteMessage(context_.peer());
  }
  const bool takes_one_message = method_ != nullptr && !method_->client_streaming();
  if (takes_one_message &&
      methods.QueryInterceptionHookPoint(InterceptionHookPoints::POST_RECV_MESSAGE)) {
    lacks_message_ = methods.GetRecvMessage() == nullptr;
  }
  if (methods.QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_STATUS) &&
      (lacks_message_ || context_.IsCancelled())) {
    rules_.connections->NoteAbandoned(context_.peer());
  }
}

void CallGuard::TakeCredentials(std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
  certificates_ = CertificateNames(context_);
  const auto [begin, end] =
      metadata.equal_range(grpc::string_ref(kAuthorization.data(), kAuthorization.size()));
  for (auto it = begin; it != end; ++it) {
    const absl::string_view value(it->second.data(), it->second.size());
    const bool is_bearer = absl::StartsWithIgnoreCase(value, kBearer);
    tokens_.push_back(is_bearer ? HashToken(std::string(value.substr(kBearer.size()))) : "");
  }
  metadata.erase(begin, end);  // handlers cannot log it
}

void CallGuard::TakeRequestId(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
  if (method_ == nullptr) return;
  const auto sent = metadata.find(kRequestIdKey);
  if (sent != metadata.end()) request_id_.assign(sent->second.data(), sent->second.size());
  if (!IsRequestId(request_id_)) request_id_ = MakeRequestId();
  context_.AddTrailingMetadata(kRequestIdKey, request_id_);
}

absl::StatusOr<const v1::Identity*> CallGuard::Identify(const Identities& identities) const {
  if (tokens_.size() > 1) {
    return absl::UnauthenticatedError("the call has several tokens; send one");
  }
  if (!tokens_.empty()) {
    if (const v1::Identity* found = identities.FindTokenHash(tokens_.front())) return found;
    return absl::UnauthenticatedError(
        "the token is unknown to this server: it was revoked or mistyped; get another one from the "
        "server's administrator (graspdb-server token)");
  }
  for (const CertificateName& name : certificates_) {
    if (!name.is_exact) continue;
    if (const v1::Identity* found = identities.FindCertificate(name.text)) return found;
  }
  if (certificates_.empty()) {
    return absl::UnauthenticatedError(
        "this server takes known callers only; give --token-file, or --cert and --key");
  }
  const auto add_text = [](std::string* out, const CertificateName& name) { *out += name.text; };
  return absl::UnauthenticatedError(
      absl::StrCat("the client certificate (", absl::StrJoin(certificates_, ", ", add_text),
                   ") has no identity; add it to the server's file of --identities"));
}

absl::Status CallGuard::Authorize() {
  identity_ = certificates_.empty() ? "" : certificates_.front().text;
  cell_.clear();
  operates_ = rules_.identities == nullptr;
  if (operates_) return absl::OkStatus();
  const std::shared_ptr<const Identities> identities = rules_.identities->Get();
  ASSIGN_OR_RETURN(const v1::Identity* identity, Identify(*identities));
  identity_ = identity->name();
  cell_ = identity->cell();
  operates_ = HasRole(*identity, v1::ROLE_OPERATE);
  const v1::Role role = method_ == nullptr ? v1::ROLE_UNSPECIFIED : RoleOf(*method_);
  if (role == v1::ROLE_UNSPECIFIED) return absl::PermissionDeniedError("the method has no role");
  if (HasRole(*identity, role)) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrCat(
      "identity ", identity_, " lacks the role ", RoleName(role), ", which ", method_->name(),
      " takes; add it in the server's file of --identities, or use another identity"));
}

absl::Status CallGuard::AuthorizeRequest(const google::protobuf::Message& request) const {
  if (cell_.empty()) return absl::OkStatus();
  const std::optional<std::string> named = CellOf(request);
  const std::string& service = method_->service()->name();
  const bool is_about_cells = service == "CellService" || service == "ChangeService";
  if (named == cell_ || (!named && !is_about_cells)) return absl::OkStatus();
  return absl::PermissionDeniedError(absl::StrCat("identity ", identity_, " may use ", cell_,
                                                  " only, not ",
                                                  named && !named->empty() ? *named : "all cells"));
}

absl::Status CallGuard::TakePlace() {
  if (rules_.places == nullptr || method_ == nullptr) return absl::OkStatus();
  if (place_) {
    place_->NoteUse();
    return absl::OkStatus();
  }
  const bool is_stream = method_->client_streaming() || method_->server_streaming();
  CallPlaces::Caller caller = {identity_, !identity_.empty()};
  if (!caller.is_identified) caller.name = NetworkOfPeer(context_.peer());
  ASSIGN_OR_RETURN(
      CallPlaces::Place place,
      rules_.places->Take(is_stream ? CallPlaces::Kind::kStream : CallPlaces::Kind::kUnary,
                          std::move(caller), method_->client_streaming() ? &context_ : nullptr));
  place_.emplace(std::move(place));
  return absl::OkStatus();
}

absl::Status CallGuard::CheckPlace() const {
  if (!place_ || !place_->is_cancelled()) return absl::OkStatus();
  return absl::CancelledError(
      "the client has sent nothing for a while, and another stream needed the place");
}

void CallGuard::NoteRequest(const google::protobuf::Message& request) {
  if (rules_.audit != nullptr) NoteResource(ResourceOf(request));
}

void CallGuard::NoteResource(std::string_view name) {
  if (rules_.audit == nullptr || name.empty() || resources_.size() == kMaxResources) return;
  std::string bounded = BoundedText(name, kMaxStringBytes);
  if (resources_.empty() || resources_.back() != bounded) resources_.push_back(std::move(bounded));
}

void CallGuard::NoteForLog(std::string_view key, std::string_view value) {
  absl::StrAppend(&notes_, " ", std::string(key), "=", LogField(value));
}

std::string CallGuard::TakeLogFields() {
  return absl::StrCat(" request_id=", request_id_, std::exchange(notes_, ""));
}

void RecordRefusedHandshake(const AccessRules& rules, const absl::Status& refused) {
  const std::string error = BoundedText(std::string(refused.message()), 2 * kMaxStringBytes);
  spdlog::warn("event=handshake_refused error={}", LogField(error));
  if (rules.audit == nullptr) return;
  v1::AuditRecord record;
  *record.mutable_time() = AuditTime();
  record.set_method("TLS handshake");
  record.set_catalog_revision(rules.revision());
  record.set_code(absl::StatusCodeToString(refused.code()));
  record.set_error(error);
  rules.audit->Write(record);
}

void CallGuard::Record(std::string_view method, const grpc::Status& status,
                       absl::Duration time) const {
  if (metrics() != nullptr) metrics()->CountCall(method, status, time);
  Audit(status);
}

void CallGuard::Audit(const grpc::Status& status) const {
  const bool is_refused = status.error_code() == grpc::StatusCode::PERMISSION_DENIED ||
                          status.error_code() == grpc::StatusCode::UNAUTHENTICATED;
  if (method_ != nullptr && (is_refused || IsAudited(*method_))) WriteAuditRecord(status);
}

void CallGuard::WriteAuditRecord(const grpc::Status& status) const {
  if (rules_.audit == nullptr) return;
  v1::AuditRecord record;
  *record.mutable_time() = AuditTime();
  record.set_identity(identity_);
  record.set_peer(context_.peer());
  record.set_method(method_->full_name());
  for (const std::string& resource : resources_) record.add_resources(resource);
  record.set_catalog_revision(rules_.revision());
  record.set_code(absl::StatusCodeToString(static_cast<absl::StatusCode>(status.error_code())));
  record.set_error(status.error_message());
  record.set_request_id(request_id_);
  rules_.audit->Write(record);
}

void CallGuard::RecordWithoutPlace(std::string_view method, const grpc::Status& status) {
  if (metrics() != nullptr) metrics()->CountCall(method, status, absl::ZeroDuration());
  const std::optional<std::int64_t> count = rules_.places->CountRefusal();
  if (!count) return;
  spdlog::warn("event=calls_refused count={} method={} identity={} peer={} error={}", *count,
               method, LogField(identity_), LogField(context_.peer()),
               LogField(status.error_message()));
  WriteAuditRecord(status);
}

}  // namespace graspdb::server
