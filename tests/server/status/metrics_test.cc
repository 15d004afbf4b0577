// Metrics of a server, as Prometheus reads them.
#include <gmock/gmock.h>

#include <asio/ip/tcp.hpp>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/certificates.h"
#include "tests/testing/scrape.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using ::testing::HasSubstr;

constexpr char kLocal[] = "127.0.0.1:0";

class MetricsTest : public ServerTest {
 protected:
  void SetUp() override {
    options_.metrics.listen = kLocal;
    options_.queue = 5;
    options_.backup_dir = (folder_.path() / "backups").string();
    std::filesystem::create_directory(options_.backup_dir);
    ServerTest::SetUp();
  }

  std::string Scrape() { return HttpGet(server_->metrics_address(), "/metrics"); }
  double Value(const std::string& series) { return ValueOf(Scrape(), series); }

  void CreateCell() {
    v1::CreateCellRequest request;
    request.set_cell_id("press-3");
    ASSERT_THAT(Call(&Cells::CreateCell, request), IsGrpcOk());
  }

  static v1::RecognizeRequest RequestOfCell(const Frame& frame) {
    v1::RecognizeRequest out = RequestOf(frame);
    out.set_cell("cells/press-3");
    return out;
  }
};

TEST_F(MetricsTest, EachMetricIsInTheDocumentAsItIsServed) {
  auto served = MetricsIn(Scrape());
  const auto documented = MetricsInDocument(GRASPDB_SOURCE_DIR "/docs/metrics.md", "Server");
  EXPECT_GT(served.size(), 40U);
  for (const auto& [name, text] : served) {
    const auto row = documented.find(name);
    const std::string wanted =
        absl::StrCat("| `", name, "` | ", text.type, " | | ", text.help, " |");
    ASSERT_TRUE(row != documented.end()) << "docs/metrics.md needs: " << wanted;
    EXPECT_TRUE(row->second == text) << "docs/metrics.md needs: " << wanted;
  }
  for (const auto& [name, text] : documented) EXPECT_TRUE(served.contains(name)) << name;
}

TEST_F(MetricsTest, CountsFramesByCellAndStatus) {
  CreateCell();
  Teach("wedge", 2);
  EXPECT_EQ(Answer(RequestOfCell(Photograph("wedge", {}, 3))).status(), v1::OK);
  EXPECT_EQ(Answer(RequestOfCell(PhotographEmptyTable())).status(), v1::NO_CLUSTER);
  const auto cell = [](const char* name, const char* status) {
    return absl::StrCat(name, "{cell=\"cells/press-3\",status=\"", status, "\"}");
  };
  EXPECT_EQ(Value(cell("graspdb_detections_total", "UNKNOWN_OBJECT")), 0);
  v1::RecognizeRequest strict = RequestOfCell(Photograph("flange", {.turn_deg = 10}, 3));
  strict.mutable_pipeline()->set_min_score(1);
  EXPECT_EQ(Answer(strict).status(), v1::UNKNOWN_OBJECT);
  const std::string text = Scrape();
  EXPECT_EQ(ValueOf(text, cell("graspdb_frames_total", "OK")), 1);
  EXPECT_EQ(ValueOf(text, cell("graspdb_frames_total", "NO_CLUSTER")), 1);
  EXPECT_EQ(ValueOf(text, cell("graspdb_detections_total", "OK")), 1);
  EXPECT_EQ(ValueOf(text, cell("graspdb_detections_total", "UNKNOWN_OBJECT")), 1);
  EXPECT_EQ(ValueOf(text, "graspdb_detection_score_count"), 1);
  for (const char* step : {"queue", "decode", "segment", "describe", "match", "register"}) {
    EXPECT_EQ(ValueOf(text, absl::StrCat("graspdb_frame_step_duration_seconds_count{step=\"", step,
                                         "\"}")),
              3);
  }
  EXPECT_GT(ValueOf(text, "graspdb_frame_step_duration_seconds_sum{step=\"segment\"}"), 0);
  EXPECT_EQ(ValueOf(text, "graspdb_call_duration_seconds_count{method=\"Recognize\"}"), 3);
}

TEST_F(MetricsTest, CountsRejectedCallsByReason) {
  v1::GetCellRequest request;
  request.set_name("cells/none");
  EXPECT_FALSE(Call(&Cells::GetCell, request).ok());
  EXPECT_EQ(Value("graspdb_rejected_calls_total{reason=\"NOT_FOUND\"}"), 1);
  EXPECT_EQ(Value("graspdb_calls_total{method=\"GetCell\",code=\"NOT_FOUND\"}"), 1);
}

TEST_F(MetricsTest, CountsPicksByCellAndObject) {
  CreateCell();
  Declare("wedge");
  v1::ReportGraspOutcomeRequest report;
  report.set_name(FlatPoseOf("wedge"));
  report.set_grasp_id(Part("wedge").grasps[0].grasp_id());
  report.set_outcome(v1::GRASP_OUTCOME_MISSED);
  report.set_count(3);
  report.set_cell("cells/press-3");
  report.set_request_id("123e4567-e89b-42d3-a456-426614174000");
  for (int i = 0; i < 2; ++i) {  // a repeated report is not counted again
    ASSERT_THAT(Call(&Catalog::ReportGraspOutcome, report), IsGrpcOk());
  }
  const auto picks = [&](const char* outcome) {
    return Value(absl::StrCat("graspdb_picks_total{cell=\"cells/press-3\",object=\"objects/wedge\"",
                              ",outcome=\"GRASP_OUTCOME_", outcome, "\"}"));
  };
  EXPECT_EQ(picks("MISSED"), 3);
  EXPECT_EQ(picks("PICKED"), 0);
  report.set_cell("cells/none");
  EXPECT_EQ(Call(&Catalog::ReportGraspOutcome, report).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(MetricsTest, ReadsTheStateOfCatalogueAndBackups) {
  Teach("wedge", 2);
  std::string text = Scrape();
  EXPECT_EQ(ValueOf(text, "graspdb_serving"), 1);
  EXPECT_EQ(ValueOf(text, "graspdb_index_views"), 2);
  EXPECT_EQ(ValueOf(text, "graspdb_index_revision"), 4);
  EXPECT_EQ(ValueOf(text, "graspdb_catalogue_revision"), 4);
  EXPECT_EQ(ValueOf(text, "graspdb_catalogue_records{kind=\"object\"}"), 1);
  EXPECT_EQ(ValueOf(text, "graspdb_queue_places{queue=\"recognise\"}"), 5);
  EXPECT_GT(ValueOf(text, "graspdb_database_memtable_bytes"), 0);
  EXPECT_GT(ValueOf(text, "graspdb_disk_available_bytes"), 0);
  EXPECT_EQ(ValueOf(text, "graspdb_backups"), 0);
  EXPECT_EQ(ValueOf(text, "graspdb_backup_age_seconds"), -1);
  grpc::ClientContext context;
  const auto reader = StubOf<BackupStub>().CreateBackup(&context, v1::CreateBackupRequest());
  for (v1::CreateBackupResponse message; reader->Read(&message);) continue;
  ASSERT_THAT(reader->Finish(), IsGrpcOk());
  text = Scrape();
  EXPECT_EQ(ValueOf(text, "graspdb_backups"), 1);
  EXPECT_GE(ValueOf(text, "graspdb_backup_age_seconds"), 0);
}

TEST_F(MetricsTest, ReadsWhenTheCertificateExpires) {
  const Authority plant("plant");
  const KeyPair pair = plant.IssueForLoopback(1000);
  folder_.Write("server.pem", pair.certificate);
  folder_.Write("server.key", pair.key);
  options_.tls.cert = (folder_.path() / "server.pem").string();
  options_.tls.key = (folder_.path() / "server.key").string();
  Restart();
  const double end = Value("graspdb_certificate_end_time_seconds");
  const double now = absl::ToDoubleSeconds(absl::Now() - absl::UnixEpoch());
  EXPECT_GT(end, now);
  EXPECT_LE(end, now + 1001);
}

TEST_F(MetricsTest, CountsAuditRecordsThatAreLost) {
  EXPECT_EQ(Value("graspdb_file_failed{file=\"audit\"}"), -1);
  options_.audit_log = "/dev/full";
  Restart();
  EXPECT_EQ(Value("graspdb_file_failed{file=\"audit\"}"), 0);
  EXPECT_EQ(Value("graspdb_audit_lost_records_total"), 0);
  ASSERT_THAT(CreateObject("mug"), IsGrpcOk());
  EXPECT_EQ(Value("graspdb_file_failed{file=\"audit\"}"), 1);
  EXPECT_EQ(Value("graspdb_audit_lost_records_total"), 1);
}

TEST_F(MetricsTest, ASilentClientDoesNotBlockOthers) {
  asio::io_context context;
  asio::ip::tcp::socket silent(context);
  const std::string& address = server_->metrics_address();
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  silent.connect({asio::ip::make_address("127.0.0.1"), static_cast<std::uint16_t>(port)});
  EXPECT_EQ(Value("graspdb_serving"), 1);
}

TEST_F(MetricsTest, OtherPathsAreNotFound) {
  for (const char* path : {"/", "/etc/passwd", "/../db/CURRENT"}) {
    EXPECT_THAT(HttpGet(server_->metrics_address(), path), HasSubstr("404")) << path;
  }
}

TEST_F(MetricsTest, OtherAddressesNeedAFlagAndAFreePort) {
  const auto start = [&](const std::string& listen) {
    server::ServerOptions options;
    options.database = (folder_.path() / "other").string();
    options.listen = kLocal;
    options.metrics.listen = listen;
    return server::Server::Start(options).status();
  };
  EXPECT_THAT(start("0.0.0.0:0"),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("--allow-remote-metrics")));
  EXPECT_THAT(start("nowhere"), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(start(server_->metrics_address()),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr(server_->metrics_address())));
}

}  // namespace
}  // namespace graspdb::testing
