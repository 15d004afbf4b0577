// Responses through the gateway beside those of direct calls, for every method that it forwards.
#include <gmock/gmock.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "console/connect_protocol.h"
#include "console/methods.h"
#include "graspdb/v1/change_service.pb.h"
#include "graspdb/v1/upload_service.grpc.pb.h"
#include "tests/console/direct_call.h"
#include "tests/console/gateway_fixture.h"

namespace graspdb::testing {
namespace {

using google::protobuf::Message;
using google::protobuf::MethodDescriptor;

constexpr char kPackage[] = "/graspdb.v1.";

struct Step {
  std::string method;  // "CatalogService/GetObject"
  std::string request;
};

std::unique_ptr<Message> NewMessage(const google::protobuf::Descriptor* type) {
  return std::unique_ptr<Message>(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(type)->New());
}

const MethodDescriptor& MethodOf(const std::string& method) {
  return *console::FindMethod(kPackage + method);
}

// A request in JSON.
Step Json(const std::string& method, const std::string& request = "{}") {
  absl::StatusOr<std::string> bytes =
      console::RequestBytes(MethodOf(method), console::Encoding::kJson, request);
  EXPECT_THAT(bytes, IsOk());
  return {method, bytes.ok() ? *bytes : ""};
}

std::string TextOf(const google::protobuf::Descriptor* type, const std::string& bytes) {
  const std::unique_ptr<Message> message = NewMessage(type);
  EXPECT_TRUE(message->ParseFromString(bytes));
  return JsonOf(*message);
}

// A response in binary or in JSON.
std::unique_ptr<Message> ParsedResponse(const google::protobuf::Descriptor* type,
                                        const std::string& text) {
  std::unique_ptr<Message> out = NewMessage(type);
  EXPECT_TRUE(absl::StartsWith(text, "{")
                  ? google::protobuf::util::JsonStringToMessage(text, out.get()).ok()
                  : out->ParseFromString(text));
  return out;
}

// Clears times, and the fields of these names, at any depth.
void Clear(const std::set<std::string>& names, Message* message) {
  const google::protobuf::Reflection& reflection = *message->GetReflection();
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  reflection.ListFields(*message, &fields);
  for (const google::protobuf::FieldDescriptor* field : fields) {
    const bool is_time = field->message_type() != nullptr &&
                         field->message_type()->full_name() == "google.protobuf.Timestamp";
    if (is_time || names.contains(field->name())) {
      reflection.ClearField(message, field);
    } else if (field->message_type() != nullptr && field->is_repeated()) {
      for (int i = 0; i < reflection.FieldSize(*message, field); ++i) {
        Clear(names, reflection.MutableRepeatedMessage(message, field, i));
      }
    } else if (field->message_type() != nullptr) {
      Clear(names, reflection.MutableMessage(message, field));
    }
  }
}

class GatewayBytesTest : public ConsoleTest<ServerTest> {
 protected:
  void SetUp() override {
    options_.backup_dir = Folder("backups");
    ServerTest::SetUp();
    Teach("flange", 3);
    Teach("wedge", 2);
    StartGateway();
  }

  std::string Folder(const std::string& name) const {
    const std::filesystem::path path = folder_.path() / name;
    std::filesystem::create_directory(path);
    return path.string();
  }

  // The messages of a call through the gateway; their number is that of the direct one.
  std::vector<std::string> Forwarded(HttpClient& browser, const Step& step,
                                     console::Encoding encoding) {
    const MethodDescriptor& method = MethodOf(step.method);
    const bool is_json = encoding == console::Encoding::kJson;
    std::string body = is_json ? TextOf(method.input_type(), step.request) : step.request;
    if (!method.server_streaming() && !method.client_streaming()) {
      const HttpResponse response =
          browser.Call(kPackage + step.method, is_json ? kJson : kProto, body);
      EXPECT_EQ(response.status, 200) << step.method << response.body;
      return {response.body};
    }
    const HttpResponse response = browser.Call(
        kPackage + step.method, is_json ? kJsonStream : kProtoStream, console::Envelope(body));
    std::vector<std::string> out;
    for (const StreamMessage& message : MessagesOf(response.body)) {
      if (message.flags == 0) {
        out.push_back(message.bytes);
      } else {
        EXPECT_EQ(message.bytes, "{}") << step.method;
      }
    }
    return out;
  }

  // One response in each encoding. Returns the number of calls.
  int ExpectSame(HttpClient& browser, const Step& step) {
    const google::protobuf::Descriptor* type = MethodOf(step.method).output_type();
    const DirectResponse direct = DirectCall(channel_, kPackage + step.method, step.request);
    EXPECT_TRUE(direct.status.ok()) << step.method << direct.status.error_message();
    EXPECT_EQ(Forwarded(browser, step, console::Encoding::kBinary), direct.messages) << step.method;
    std::vector<std::string> texts;
    for (const std::string& message : direct.messages) texts.push_back(TextOf(type, message));
    EXPECT_EQ(Forwarded(browser, step, console::Encoding::kJson), texts) << step.method;
    return 2;
  }

  // Calls that change nothing and depend on nothing but the catalogue.
  static std::vector<Step> Reads() {
    const std::string pose = R"("objects/flange/stablePoses/flat")";
    const std::string view = R"("objects/flange/stablePoses/flat/views/turn-)";
    return {
        Json("CatalogService/ListObjects"),
        Json("CatalogService/ListObjects", R"({"pageSize":1})"),
        Json("CatalogService/GetObject", R"({"name":"objects/wedge"})"),
        Json("CatalogService/ListStablePoses", R"({"parent":"objects/wedge"})"),
        Json("CatalogService/GetStablePose", absl::StrCat(R"({"name":)", pose, "}")),
        Json("CatalogService/ListViews", absl::StrCat(R"({"parent":)", pose, R"(,"pageSize":2})")),
        Json("CatalogService/GetView", absl::StrCat(R"({"name":)", view, R"(1"})")),
        Json("CatalogService/GetView",
             absl::StrCat(R"({"name":)", view, R"(2","detail":"VIEW_DETAIL_FULL"})")),
        Json("CellService/ListCells"),
        Json("CellService/GetCell", R"({"name":"cells/press"})"),
        Json("ObjectHistoryService/ListDeletedObjects"),
        Json("ObjectHistoryService/GetDeletedObject", R"({"name":"objects/gone"})"),
        Json("ObjectHistoryService/ListObjectRevisions", R"({"parent":"objects/flange"})"),
        Json("UploadService/ListUploads"),
        Json("UploadService/GetUpload", R"({"name":"uploads/open"})"),
        Json("UploadService/ListUploadViews", R"({"parent":"uploads/open"})"),
        Json("BackupService/ListBackups"),
        Json("BackupService/CompareBackup", R"({"name":"backups/1"})"),
    };
  }
  // The same, some milliseconds each.
  static std::vector<Step> SlowReads() {
    return {Json("RecognitionService/FindLookAlikes"),
            {"RecognitionService/Recognize",
             RequestOf(Photograph("flange", {.turn_deg = 40}, 3)).SerializeAsString()},
            {"RecognitionService/RecognizeStream", StreamedFrame().SerializeAsString()},
            Json("RecognitionService/ProposeThresholds", R"({"object":"objects/wedge"})")};
  }
  static v1::RecognizeStreamRequest StreamedFrame() {
    v1::RecognizeStreamRequest out;
    out.set_frame_id("7");
    *out.mutable_request() = RequestOf(Photograph("wedge", {.turn_deg = 10}, 4));
    return out;
  }
  // What these calls find.
  static std::vector<Step> Preparation() {
    return {
        Json("CellService/CreateCell", R"({"cellId":"press","cell":{"displayName":"\u00e4"}})"),
        Json("CatalogService/CreateObject", R"({"objectId":"gone"})"),
        Json("CatalogService/DeleteObject", R"({"name":"objects/gone"})"),
        Json("UploadService/CreateUpload",
             R"({"uploadId":"open","upload":{"expectedViewCount":"7"}})"),
        Json("BackupService/CreateBackup",
             R"({"requestId":"7c9e6679-7425-40de-944b-e07fc1f90ae7"})"),
    };
  }
  static v1::WriteUploadViewsRequest StagedView() {
    v1::WriteUploadViewsRequest out;
    out.set_upload("uploads/open");
    *out.mutable_view() = ViewOf("flange", 88, "turn-88");
    return out;
  }
  // Every method that changes something: a story whose responses are the same on equal catalogues.
  static std::vector<Step> Writes() {
    const std::string box = R"("objects/box")";
    const std::string up = R"("objects/box/stablePoses/up")";
    std::vector<Step> out = Preparation();
    const std::vector<Step> more = {
        Json("CatalogService/CreateObject",
             R"({"objectId":"box","object":{"displayName":"A box","labels":["a","b"]}})"),
        Json("CatalogService/UpdateObject",
             absl::StrCat(R"({"object":{"name":)", box,
                          R"(,"release":"RELEASE_STATE_DRAFT"},"updateMask":"release"})")),
        Json("CatalogService/CreateStablePose",
             absl::StrCat(R"({"parent":)", box, R"(,"stablePoseId":"up","stablePose":{"grasps":[)",
                          R"({"graspId":"g","tcpPose":{"position":{"z":0.1},)",
                          R"("orientation":{"w":1}}}]}})")),
        Json("CatalogService/UpdateStablePose",
             absl::StrCat(R"({"stablePose":{"name":)", up,
                          R"(,"minScore":0.7},"updateMask":"minScore"})")),
        Json("CatalogService/ReportGraspOutcome",
             absl::StrCat(R"({"name":)", up,
                          R"(,"graspId":"g","outcome":"GRASP_OUTCOME_SLIPPED","count":3})")),
        Json("CatalogService/DeleteView",
             R"({"name":"objects/flange/stablePoses/flat/views/turn-0"})"),
        Json("CatalogService/DeleteStablePose",
             R"({"name":"objects/wedge/stablePoses/flat","force":true})"),
        Json("CellService/UpdateCell",
             R"({"cell":{"name":"cells/press","labels":["a"]},"updateMask":"labels"})"),
        Json("CellService/DeleteCell", R"({"name":"cells/press"})"),
        Json("CatalogService/DeleteObject", absl::StrCat(R"({"name":)", box, R"(,"force":true})")),
        Json("ObjectHistoryService/UndeleteObject", absl::StrCat(R"({"name":)", box, "}")),
        Json("ObjectHistoryService/RestoreObject", R"({"name":"objects/wedge","revision":"6"})"),
        Json("ObjectHistoryService/PurgeObject", R"({"name":"objects/gone"})"),
        {"CatalogService/UploadViews", ViewOf("flange", 77, "turn-77").SerializeAsString()},
        {"UploadService/WriteUploadViews", StagedView().SerializeAsString()},
        Json("UploadService/CommitUpload", R"({"name":"uploads/open"})"),
        Json("UploadService/DeleteUpload", R"({"name":"uploads/open"})"),
        Json("BackupService/VerifyBackup", R"({"name":"backups/1"})"),
        Json("BackupService/DeleteBackup", R"({"name":"backups/1"})"),
    };
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
};

TEST_F(GatewayBytesTest, TenThousandReadsGiveTheBytesOfDirectCalls) {
  for (const Step& step : Preparation()) {
    ASSERT_TRUE(DirectCall(channel_, kPackage + step.method, step.request).status.ok())
        << step.method;
  }
  HttpClient browser = Connect();
  int calls = 0;
  for (const Step& step : SlowReads()) {
    for (int i = 0; i < 3; ++i) calls += ExpectSame(browser, step);
  }
  const std::vector<Step> reads = Reads();
  while (calls < 10'000 && !HasFailure()) {
    for (const Step& step : reads) calls += ExpectSame(browser, step);
  }
}

// Two servers begin with the same catalogue, and get the same calls: one directly, one through the
// gateway.
TEST_F(GatewayBytesTest, WritesGiveTheResponsesOfDirectWrites) {
  server_.reset();
  const std::string twin_folder = (folder_.path() / "twin").string();
  std::filesystem::copy(options_.database, twin_folder, std::filesystem::copy_options::recursive);
  Restart();
  StartGateway();
  server::ServerOptions twin_options = options_;
  twin_options.database = twin_folder;
  twin_options.backup_dir = Folder("twin-backups");
  const auto twin = server::Server::Start(twin_options);
  ASSERT_THAT(twin, IsOk());
  const auto twin_channel = (*twin)->InProcessChannel();
  HttpClient browser = Connect();
  int step_number = 0;
  for (const Step& step : Writes()) {
    const google::protobuf::Descriptor* type = MethodOf(step.method).output_type();
    const DirectResponse direct = DirectCall(twin_channel, kPackage + step.method, step.request);
    ASSERT_TRUE(direct.status.ok()) << step.method << direct.status.error_message();
    const std::vector<std::string> forwarded =
        Forwarded(browser, step,
                  step_number++ % 2 == 0 ? console::Encoding::kBinary : console::Encoding::kJson);
    ASSERT_FALSE(forwarded.empty() || direct.messages.empty()) << step.method;
    // The last message of a stream; those before are the progress, which depends on time.
    const std::unique_ptr<Message> here = ParsedResponse(type, forwarded.back());
    const std::unique_ptr<Message> there = ParsedResponse(type, direct.messages.back());
    // Times differ, and so do the sizes of the files that have them.
    for (Message* message : {here.get(), there.get()}) {
      Clear({"byte_count", "done_byte_count"}, message);
    }
    EXPECT_EQ(JsonOf(*here), JsonOf(*there)) << step.method;
  }
}

TEST_F(GatewayBytesTest, TheStatusIsThatOfTheServer) {
  HttpClient browser = Connect();
  const Step step = Json("CatalogService/GetCatalogStatus");
  v1::CatalogStatus here;
  ASSERT_TRUE(here.ParseFromString(Forwarded(browser, step, console::Encoding::kBinary).front()));
  v1::CatalogStatus there = Status();
  // Of time, memory and disk. The caches still fill from the start of the server.
  for (v1::CatalogStatus* status : {&here, &there}) {
    Clear({"uptime_s", "memory", "server_state", "disk", "hit_count", "miss_count", "byte_count",
           "last_good_age_s"},
          status);
  }
  EXPECT_EQ(JsonOf(here), JsonOf(there));
  EXPECT_EQ(here.view_count(), 5);
}

// The messages in a body of chunks that has not ended.
std::vector<std::string> MessagesSoFar(const std::string& received) {
  std::string body;
  std::size_t at = received.find("\r\n\r\n");
  while (at != std::string::npos && at + 4 < received.size()) {
    at = at + (body.empty() ? 4 : 2);
    const std::size_t line = received.find("\r\n", at);
    if (line == std::string::npos) break;
    const std::size_t size = std::stoul(received.substr(at, line - at), nullptr, 16);
    body += received.substr(line + 2, size);
    at = line + 2 + size;
    if (at >= received.size()) break;
  }
  std::vector<std::string> out;
  for (at = 0; at + 5 <= body.size();) {
    std::size_t size = 0;
    for (std::size_t i = 1; i < 5; ++i) size = size << 8 | static_cast<unsigned char>(body[at + i]);
    if (at + 5 + size > body.size()) break;
    out.push_back(body.substr(at + 5, size));
    at += 5 + size;
  }
  return out;
}

TEST_F(GatewayBytesTest, ChangesAreThoseOfTheServer) {
  const v1::CatalogStatus status = Status();
  const Step step = Json("ChangeService/WatchCatalog",
                         R"({"afterRevision":"0","includeRecords":true,"heartbeatS":3600})");
  const auto changes = static_cast<std::size_t>(status.catalog_revision());
  const DirectResponse direct = DirectCall(channel_, kPackage + step.method, step.request, changes);
  ASSERT_EQ(direct.messages.size(), changes);
  HttpClient browser = Connect();
  const std::string body = console::Envelope(step.request);
  browser.SendBytes(absl::StrCat(
      "POST ", kPackage, step.method, " HTTP/1.1\r\nHost: 127.0.0.1:", gateway_->port(),
      "\r\nContent-Type: ", kProtoStream, "\r\nContent-Length: ", body.size(), "\r\n\r\n", body));
  std::string received;
  std::vector<std::string> messages;
  while (messages.size() < changes) {
    const std::string bytes = browser.ReceiveBytes();
    ASSERT_NE(bytes, "") << received;
    received += bytes;
    messages = MessagesSoFar(received);
  }
  messages.resize(changes);
  EXPECT_EQ(messages, direct.messages);
}

TEST_F(GatewayBytesTest, NoMethodIsLeftOut) {
  std::set<std::string> compared = {"CatalogService/GetCatalogStatus",
                                    "ChangeService/WatchCatalog"};
  for (const std::vector<Step>& steps : {Reads(), SlowReads(), Writes()}) {
    for (const Step& step : steps) compared.insert(step.method);
  }
  for (const std::string& path : console::MethodPaths()) {
    const std::string method = path.substr(sizeof(kPackage) - 1);
    EXPECT_TRUE(compared.contains(method)) << method;
  }
}

}  // namespace
}  // namespace graspdb::testing
