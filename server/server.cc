#include "server/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/admission.h"
#include "server/catalog_service.h"
#include "server/cell_service.h"
#include "server/frame_recognizer.h"
#include "server/index_keeper.h"
#include "server/live_catalogue.h"
#include "server/recognition_service.h"
#include "server/view_cloud_cache.h"
#include "storage/catalogue.h"

namespace graspdb::server {
namespace {

// Uploads that may wait for their turn to be taught.
constexpr int kTeachQueue = 64;

// Threads that wait for calls, at least that many of which are kept.
constexpr int kLeastPollers = 8;

// A shutdown ends the streams of those who watch the health, told or not.
constexpr std::chrono::milliseconds kTimeToBeHeard{200};

recognition::RecognitionParameters ParametersOf(const ServerOptions& options) {
  recognition::RecognitionParameters out;
  out.descriptor.kind =
      recognition::DescriptorFromName(options.descriptor).value_or(out.descriptor.kind);
  out.descriptor.voxel_size_m = options.voxel_size_m;
  out.descriptor.normal_radius_m = options.normal_radius_m;
  return out;
}

int WorkersOf(const ServerOptions& options) {
  if (options.workers > 0) return options.workers;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace

// Everything below gRPC, in the order in which the parts need each other.
struct Server::Parts {
  Parts(const ServerOptions& options, std::unique_ptr<storage::Catalogue> catalogue_in,
        std::unique_ptr<LiveCatalogue> live_in)
      : parameters(ParametersOf(options)),
        max_points(static_cast<std::size_t>(options.max_points)),
        catalogue(std::move(catalogue_in)),
        live(std::move(live_in)),
        index_keeper(*catalogue, *live, parameters.descriptor),
        clouds(*catalogue, parameters.descriptor,
               static_cast<std::size_t>(options.cache_mib) << 20U),
        recognizing(WorkersOf(options), options.queue),
        recognizer(*catalogue, *live, clouds, parameters, max_points),
        check(*live, clouds, parameters),
        recognition_service(recognizer, check, recognizing),
        catalog_service({*catalogue, *live, teaching, clouds, parameters, {max_points}}),
        cell_service(*catalogue) {}

  recognition::RecognitionParameters parameters;
  std::size_t max_points;
  std::unique_ptr<storage::Catalogue> catalogue;
  std::unique_ptr<LiveCatalogue> live;
  IndexKeeper index_keeper;
  ViewCloudCache clouds;
  Admission recognizing;
  Admission teaching{1, kTeachQueue};
  FrameRecognizer recognizer;
  CatalogueCheck check;
  RecognitionService recognition_service;
  CatalogService catalog_service;
  CellService cell_service;
};

Server::Server(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Server::~Server() { Stop(); }

absl::StatusOr<std::unique_ptr<Server>> Server::Start(const ServerOptions& options) {
  if (absl::Status status = CheckListenAddress(options); !status.ok()) return status;
  absl::StatusOr<std::unique_ptr<storage::Catalogue>> catalogue =
      storage::Catalogue::Open(options.database, {.keep_changes = options.keep_changes});
  if (!catalogue.ok()) return catalogue.status();
  absl::StatusOr<std::unique_ptr<LiveCatalogue>> live =
      LiveCatalogue::Follow(**catalogue, ParametersOf(options).descriptor);
  if (!live.ok()) return live.status();
  std::unique_ptr<Server> out(
      new Server(std::make_unique<Parts>(options, *std::move(catalogue), *std::move(live))));
  out->drain_time_ = std::chrono::duration<double>(options.drain_s);

  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  const int max_bytes = options.max_message_mib << 20;
  builder.SetMaxReceiveMessageSize(max_bytes);
  builder.SetMaxSendMessageSize(max_bytes);
  // Two servers on one port would take turns at answering; the second must fail.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // A thread that finds more pollers than this ends, and the next frame starts a new one.
  builder.SetSyncServerOption(grpc::ServerBuilder::SyncServerOption::MAX_POLLERS,
                              std::max(kLeastPollers, 2 * WorkersOf(options)));
  int port = 0;
  builder.AddListeningPort(options.listen, grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&out->parts_->catalog_service);
  builder.RegisterService(&out->parts_->recognition_service);
  builder.RegisterService(&out->parts_->cell_service);
  out->grpc_ = builder.BuildAndStart();
  if (out->grpc_ == nullptr || port == 0) {
    return absl::UnavailableError(absl::StrCat("cannot listen on ", options.listen,
                                               "; is the port in use? Choose another --listen"));
  }
  out->address_ = absl::StrCat(options.listen.substr(0, options.listen.rfind(':')), ":", port);
  out->grpc_->GetHealthCheckService()->SetServingStatus(true);
  return out;
}

std::shared_ptr<grpc::Channel> Server::InProcessChannel() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  return grpc_->InProcessChannel(arguments);
}

void Server::Drain() {
  if (grpc_ == nullptr) return;
  grpc_->GetHealthCheckService()->SetServingStatus(false);
  std::this_thread::sleep_for(kTimeToBeHeard);
  Stop();
}

void Server::Stop() {
  if (grpc_ == nullptr) return;
  grpc_->Shutdown(std::chrono::system_clock::now() +
                  std::chrono::duration_cast<std::chrono::system_clock::duration>(drain_time_));
  grpc_->Wait();
  grpc_.reset();
  parts_.reset();
}

}  // namespace graspdb::server
