#include "server/server.h"

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>
#include <grpcpp/impl/server_builder_plugin.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <array>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "program/connections/connection_acceptor.h"
#include "program/connections/listen_address.h"
#include "program/metrics/metrics_server.h"
#include "server/access/tls.h"
#include "server/backups/backup_schedule.h"
#include "server/backups/backup_service.h"
#include "server/backups/catalogue_backups.h"
#include "server/calls/admission.h"
#include "server/calls/call_guard.h"
#include "server/calls/call_places.h"
#include "server/calls/capacity.h"
#include "server/calls/memory_budget.h"
#include "server/catalogue/catalog_service.h"
#include "server/catalogue/cell_service.h"
#include "server/history/change_service.h"
#include "server/history/expiry.h"
#include "server/history/object_history_service.h"
#include "server/live/live_catalogue.h"
#include "server/live/model_preloader.h"
#include "server/live/upkeep.h"
#include "server/live/view_cloud_cache.h"
#include "server/recognition/frame_recognizer.h"
#include "server/recognition/recognition_service.h"
#include "server/status/health.h"
#include "server/status/server_state.h"
#include "server/status/status_metrics.h"
#include "server/uploads/upload_service.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {
namespace {

// Leaves out server reflection, which its library adds to every server of the process.
class NoReflection : public grpc::ServerBuilderOption {
 public:
  void UpdateArguments(grpc::ChannelArguments* /*arguments*/) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override {
    std::erase_if(*plugins, [](const std::unique_ptr<grpc::ServerBuilderPlugin>& plugin) {
      return plugin->name() == "proto_server_reflection";
    });
  }
};

// Milliseconds after which a silent client gets a ping, and after which it is taken for gone: its
// connection is closed and its calls end. gRPC's own time is two hours.
constexpr int kServerKeepaliveMs = 30'000;
constexpr int kServerKeepaliveTimeoutMs = 20'000;
// Clients may send pings this often; gRPC's own five minutes are longer than the idle time of many
// routers.
constexpr int kMinPingMs = 10'000;
// For a new connection to begin with HTTP/2, after TLS if used. gRPC's own time is two minutes.
constexpr int kHandshakeMs = 20'000;

// The server to be built closes connections whose client does not answer a ping (within 50 s) and
// those that do not begin with HTTP/2 (within 20 s), and accepts pings of its clients every 10 s.
void EndDeadConnections(grpc::ServerBuilder& builder) {
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kServerKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kServerKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kMinPingMs);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
}

// Maximum number of waiting uploads.
constexpr int kTeachQueue = 64;

// Of the streams a quarter may wait for changes.
constexpr int kWatcherShare = 4;

// A shutdown ends the streams of health watchers, notified or not.
constexpr std::chrono::milliseconds kHealthNotifyTime{200};

recognition::RecognitionParameters ParametersOf(const ServerOptions& options) {
  recognition::RecognitionParameters out;
  out.descriptor.kind =
      recognition::DescriptorFromName(options.descriptor).value_or(out.descriptor.kind);
  out.descriptor.voxel_size_m = options.voxel_size_m;
  out.descriptor.normal_radius_m = options.normal_radius_m;
  return out;
}

// Searches for no more objects than the cache of their models holds, or each frame would make them
// anew.
recognition::RecognitionParameters ParametersWithin(const MemoryShares& memory,
                                                    const ServerOptions& options) {
  constexpr std::size_t kPairModelBytes = 3'000'000;
  recognition::RecognitionParameters out = ParametersOf(options);
  out.scene.max_objects = std::min(
      out.scene.max_objects, memory.caches / ViewCloudCache::kPairModelShare / kPairModelBytes);
  return out;
}

storage::CatalogueOptions CatalogueOptionsOf(const ServerOptions& options) {
  return {.keep_changes = options.keep_changes,
          .disk_reserve_bytes = static_cast<std::uint64_t>(options.disk_reserve_mib) << 20U};
}

// Null without a folder for backups.
absl::StatusOr<std::unique_ptr<CatalogueBackups>> OpenBackups(const ServerOptions& options,
                                                              storage::Catalogue& catalogue) {
  if (options.backup_dir.empty()) return nullptr;
  return CatalogueBackups::Open(options, catalogue);
}

// Null unless backups are scheduled.
std::unique_ptr<BackupSchedule> ScheduleBackups(const ServerOptions& options,
                                                CatalogueBackups* backups) {
  if (backups == nullptr || options.backup_every_s <= 0) return nullptr;
  storage::BackupRetention retention;
  if (options.backup_keep > 0) retention.count = options.backup_keep;
  if (options.backup_max_age_s > 0) retention.max_age = absl::Seconds(options.backup_max_age_s);
  return std::make_unique<BackupSchedule>(*backups, absl::Seconds(options.backup_every_s),
                                          retention);
}

}  // namespace

// Everything below gRPC, in the order of dependencies.
struct Server::Parts {
  Parts(const ServerOptions& options, const MemoryShares& memory,
        std::unique_ptr<storage::Catalogue> catalogue_in, std::unique_ptr<LiveCatalogue> live_in,
        std::unique_ptr<CatalogueBackups> backups_in)
      : parameters(ParametersWithin(memory, options)),
        max_points(static_cast<std::size_t>(options.max_points)),
        catalogue(std::move(catalogue_in)),
        live(std::move(live_in)),
        backups(std::move(backups_in)),
        expiry(absl::Seconds(options.deleted_objects_kept_s)),
        upkeep(*live, [this] { expiry.Run(*catalogue, absl::Now(), Expiry::Clock::now()); }),
        request_memory(memory.requests),
        clouds(*catalogue, parameters.descriptor, memory.caches,
               [this](const std::string& view) { live->LeaveOutDamaged(view); }),
        preloader(*live, clouds),
        recognizing(WorkersOf(options), QueueOf(options)),
        recognizer(*catalogue, *live, clouds, parameters, max_points),
        check(*live, clouds, parameters),
        recognition_service(recognizer, check, recognizing, request_memory),
        catalog_service({*catalogue,
                         *live,
                         teaching,
                         clouds,
                         memory,
                         request_memory,
                         parameters,
                         {max_points},
                         backups.get(),
                         [this, certificate = options.tls.cert] {
                           return ServerStateOf(
                               {*catalogue, *live, access, tls_state, certificate, backups.get()});
                         }}),
        uploading(WorkersOf(options), kTeachQueue),
        upload_service({*catalogue, uploading, request_memory, parameters, {max_points}}),
        history_service(*catalogue, parameters.descriptor, expiry.history_kept()),
        cell_service(*catalogue),
        change_service(*catalogue, *live, PlacesFor(options).streams / kWatcherShare),
        backup_service(backups.get()),
        backup_schedule(ScheduleBackups(options, backups.get())) {}

  // After Listen().
  StatusSources StatusSourcesOf(const ServerOptions& options, const MemoryShares& memory) {
    return {*catalogue, *live,       clouds,          request_memory, memory,
            *acceptor,  recognizing, teaching,        uploading,      backups.get(),
            access,     tls_state,   options.tls.cert};
  }

  recognition::RecognitionParameters parameters;
  std::size_t max_points;
  std::unique_ptr<storage::Catalogue> catalogue;
  std::unique_ptr<LiveCatalogue> live;
  std::unique_ptr<CatalogueBackups> backups;  // null: no folder for them
  Expiry expiry;                              // on the thread of `upkeep`
  Upkeep upkeep;                              // uses the members above
  RequestMemory request_memory;
  ViewCloudCache clouds;
  ModelPreloader preloader;
  Admission recognizing;
  Admission teaching{1, kTeachQueue};
  FrameRecognizer recognizer;
  CatalogueCheck check;
  RecognitionService recognition_service;
  CatalogService catalog_service;
  Admission uploading;
  UploadService upload_service;
  ObjectHistoryService history_service;
  CellService cell_service;
  ChangeService change_service;
  BackupService backup_service;
  const std::array<grpc::Service*, 7> services = {
      &catalog_service, &recognition_service, &upload_service, &history_service,
      &cell_service,    &change_service,      &backup_service};
  std::unique_ptr<BackupSchedule> backup_schedule;  // null: none are scheduled
  AccessRules access = {};
  FileState tls_state{"--tls-cert"};
  std::unique_ptr<WatchedFiles> tls_files;
  std::unique_ptr<ConnectionAcceptor> acceptor;
  std::unique_ptr<MetricsServer> metrics;  // null: none
};

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Server::~Server() { Stop(); }

absl::StatusOr<std::unique_ptr<Server>> Server::Start(
    const ServerOptions& options, const recognition::IsCancelled& is_cancelled) {
  RETURN_IF_ERROR(CheckListenAddress(options));
  RETURN_IF_ERROR(CheckTlsFiles(options.tls));
  ASSIGN_OR_RETURN(AccessRules access, OpenAccessRules(options));
  ASSIGN_OR_RETURN(std::unique_ptr<storage::Catalogue> catalogue,
                   storage::Catalogue::Open(options.database, CatalogueOptionsOf(options)));
  ASSIGN_OR_RETURN(
      std::unique_ptr<LiveCatalogue> live,
      LiveCatalogue::Follow(*catalogue, ParametersOf(options).descriptor, is_cancelled));
  ASSIGN_OR_RETURN(std::unique_ptr<CatalogueBackups> backups, OpenBackups(options, *catalogue));
  const MemoryShares memory = ShareMemory(options.memory_mib, options.cache_mib);
  std::unique_ptr<Server> out(new Server(std::make_unique<Parts>(
      options, memory, std::move(catalogue), std::move(live), std::move(backups))));
  out->drain_time_ = std::chrono::duration<double>(options.drain_s);
  out->parts_->access = std::move(access);
  out->parts_->access.places = std::make_unique<CallPlaces>(PlacesFor(options));
  out->parts_->access.connections = WatchConnections(memory, options);
  out->parts_->access.revision = [parts = out->parts_.get()] {
    return parts->catalogue->revision();
  };
  out->parts_->tls_files = WatchTlsFiles(options.tls, out->parts_->tls_state);
  RETURN_IF_ERROR(out->Listen(options));
  ASSIGN_OR_RETURN(out->parts_->metrics,
                   ServeMetrics(options.metrics, out->parts_->StatusSourcesOf(options, memory),
                                out->parts_->access.metrics.get()));
  WarnIfOpen(options);

  RETURN_IF_ERROR(out->Serve(options, memory));
  return out;
}

absl::Status Server::Listen(const ServerOptions& options) {
  ASSIGN_OR_RETURN(const ListenAddress listen, ParseListenAddress("--listen", options.listen));
  absl::StatusOr<std::unique_ptr<ConnectionAcceptor>> acceptor = ConnectionAcceptor::Listen(listen);
  if (!acceptor.ok()) {
    return absl::UnavailableError(absl::StrCat("cannot listen on ", options.listen, " (",
                                               acceptor.status().message(),
                                               "); is the port in use? Choose another --listen"));
  }
  parts_->acceptor = *std::move(acceptor);
  address_ = absl::StrCat(listen.host, ":", parts_->acceptor->port());
  return absl::OkStatus();
}

absl::Status Server::Serve(const ServerOptions& options, const MemoryShares& memory) {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  const int max_bytes = options.max_message_mib << 20;
  builder.SetMaxReceiveMessageSize(max_bytes);
  builder.SetMaxSendMessageSize(max_bytes);
  EndDeadConnections(builder);
  LimitCalls(memory, options, builder);
  const auto credentials =
      MakeServerCredentials(options.tls, [access = &parts_->access](const absl::Status& refused) {
        RecordRefusedHandshake(*access, refused);
      });
  if (!credentials.ok()) return credentials.status();
  parts_->acceptor->AddTo(builder, *credentials);
  if (options.no_reflection) builder.SetOption(std::make_unique<NoReflection>());
  GuardCalls(parts_->access, builder);
  for (grpc::Service* service : parts_->services) builder.RegisterService(service);
  grpc_ = builder.BuildAndStart();
  if (grpc_ == nullptr) {
    return absl::InternalError("gRPC does not start; the log of --log-level debug has its reason");
  }
  parts_->acceptor->Start(parts_->access.connections.get());
  health_ = std::make_unique<Health>(*parts_->live, *grpc_);
  write_watch_ = std::make_unique<WriteWatch>(
      *parts_->catalogue, [health = grpc_->GetHealthCheckService()](bool succeed) {
        health->SetServingStatus(kWritesHealth, succeed);
      });
  return absl::OkStatus();
}

std::string Server::metrics_address() const {
  return parts_->metrics == nullptr ? "" : parts_->metrics->address();
}

std::shared_ptr<grpc::Channel> Server::InProcessChannel() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return grpc_->InProcessChannel(arguments);
}

void Server::Drain() {
  if (grpc_ == nullptr) return;
  health_->Drain();
  std::this_thread::sleep_for(kHealthNotifyTime);
  Stop();
}

void Server::Stop() {
  if (grpc_ == nullptr) return;
  parts_->acceptor->Stop();
  parts_->change_service.Stop();
  parts_->preloader.Stop();
  if (parts_->backups != nullptr) parts_->backups->Stop();  // clients can start them again
  grpc_->Shutdown(std::chrono::system_clock::now() +
                  std::chrono::duration_cast<std::chrono::system_clock::duration>(drain_time_));
  grpc_->Wait();
  write_watch_.reset();
  health_.reset();
  grpc_.reset();
  parts_.reset();
}

}  // namespace graspdb::server
