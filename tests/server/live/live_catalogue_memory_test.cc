// The catalogue in memory when any allocation fails while a change is applied.
#include <gmock/gmock.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <limits>
#include <new>

#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "server/live/live_catalogue.h"
#include "server/status/health.h"
#include "tests/files/temporary_folder.h"
#include "tests/server/raw_call.h"
#include "tests/testing/status_matchers.h"

namespace {

// Only large ones fail: library functions that must not throw allocate small texts.
constexpr std::size_t kLarge = 256;  // bytes

// Large allocations of this thread that succeed before `failures` of them fail; none fails below
// zero.
thread_local int succeed_first = -1;
thread_local int failures = 0;

bool FailsNow(std::size_t size) {
  if (size < kLarge || succeed_first < 0) return false;
  if (succeed_first > 0) {
    --succeed_first;
    return false;
  }
  if (failures == 0) return false;
  --failures;
  return true;
}

}  // namespace

// Not inlined: the compiler would take malloc and free for mismatched.
[[gnu::noinline]] void* operator new(std::size_t size) {
  void* memory = FailsNow(size) ? nullptr : std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return FailsNow(size) ? nullptr : std::malloc(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace graspdb::server {
namespace {

using testing::IsOk;

// grpc.health.v1.HealthCheckResponse.
constexpr char kServing[] = "\x08\x01";
constexpr char kNotServing[] = "\x08\x02";

constexpr char kPose[] = "objects/o/stablePoses/p";
constexpr char kView[] = "objects/o/stablePoses/p/views/v";

class LiveCatalogueMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    spdlog::set_level(spdlog::level::off);
    catalogue_ = storage::Catalogue::Open((folder_.path() / "db").string()).value();
    v1::Object object;
    object.set_name("objects/o");
    ASSERT_THAT(catalogue_->CreateObject(object), IsOk());
    v1::StablePose pose;
    pose.set_name(kPose);
    ASSERT_THAT(catalogue_->CreateStablePose(pose), IsOk());
    live_ = LiveCatalogue::Follow(*catalogue_, parameters_).value();
    ASSERT_THAT(catalogue_->Subscribe([this](const storage::ChangeRecord& change) {
      succeed_first = armed_;
      try {
        live_->Apply(change);
      } catch (const std::bad_alloc&) {
        // The catalogue ignores it as well.
      }
      struck_ = armed_ >= 0 && failures < armed_failures_;
      succeed_first = -1;
    }),
                IsOk());
  }

  // Stores the view while `count` allocations fail, starting at `first`.
  void PutFailing(int first, int count) {
    storage::NewView view;
    view.record.set_name(kView);
    view.record.set_content_digest("1");
    view.record.mutable_object_pose()->mutable_orientation()->set_w(1);
    view.record.mutable_sensor_pose()->mutable_orientation()->set_w(1);
    storage::DescriptorRecord* descriptor = view.record.add_descriptors();
    descriptor->set_parameters(parameters_.Fingerprint());
    descriptor->mutable_bins()->Resize(recognition::DescriptorSize(parameters_.kind), 0.1F);
    view.packed_cloud = "never read";
    armed_ = first;
    failures = armed_failures_ = count;
    EXPECT_THAT(catalogue_->PutView(view), IsOk());
    armed_ = -1;
  }

  void ExpectSeen(int first) {
    const auto snapshot = live_->snapshot();
    EXPECT_EQ(snapshot->revision, catalogue_->revision()) << "allocation " << first;
    EXPECT_EQ(snapshot->index.view_count(), 1U) << "allocation " << first;
    EXPECT_EQ(snapshot->stable_poses->at(kPose)->views.size(), 1U) << "allocation " << first;
  }

  void Delete() {
    ASSERT_THAT(catalogue_->DeleteView(kView), IsOk());
    ASSERT_EQ(live_->snapshot()->index.view_count(), 0U);
  }

  const files::TemporaryFolder folder_;
  const recognition::DescriptorParameters parameters_ = {};
  std::unique_ptr<storage::Catalogue> catalogue_;
  std::unique_ptr<LiveCatalogue> live_;
  int armed_ = -1;
  int armed_failures_ = 0;
  bool struck_ = false;  // whether the last change was long enough for the failure to happen
};

TEST_F(LiveCatalogueMemoryTest, ViewIsVisibleAfterAnyFailedAllocation) {
  int first = 0;
  for (; first < 10'000; ++first) {
    PutFailing(first, 1);
    if (!struck_) break;
    ExpectSeen(first);
    Delete();
  }
  EXPECT_GT(first, 2);
  EXPECT_LT(first, 10'000);
}

TEST_F(LiveCatalogueMemoryTest, HealthIsNotServingUntilAFailedChangeIsInTheIndex) {
  grpc::EnableDefaultHealthCheckService(true);
  v1::CatalogService::Service service;  // without any, gRPC starts no server
  grpc::ServerBuilder builder;
  builder.RegisterService(&service);
  const std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  ASSERT_NE(server, nullptr);
  const Health health(*live_, *server);
  const auto status = [&] {
    testing::RawCall check(server->InProcessChannel({}), "/grpc.health.v1.Health/Check");
    EXPECT_TRUE(check.Write(""));
    return check.Read().value_or("no response");
  };
  EXPECT_EQ(status(), kServing);
  PutFailing(0, std::numeric_limits<int>::max());
  ASSERT_TRUE(struck_);
  EXPECT_EQ(status(), kNotServing);
  EXPECT_FALSE(live_->agrees());
  live_->CatchUp();
  EXPECT_EQ(status(), kServing);
  EXPECT_TRUE(live_->agrees());
}

TEST_F(LiveCatalogueMemoryTest, ViewIsVisibleOnceMemoryIsAvailable) {
  constexpr int kAll = std::numeric_limits<int>::max();
  for (const int first : {0, 1, 2}) {
    PutFailing(first, kAll);
    ASSERT_TRUE(struck_);
    live_->CatchUp();
    ExpectSeen(first);
    Delete();
    PutFailing(first, kAll);
    ASSERT_THAT(catalogue_->UpdateStablePose(kPose, "", [](auto&) { return absl::OkStatus(); }),
                IsOk());
    ExpectSeen(first);
    Delete();
  }
}

}  // namespace
}  // namespace graspdb::server
