// Answers of servers that do not know all fields of the contract.
#include "client/sdk/earlier_servers.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/message_differencer.h>
#include <grpcpp/server_builder.h>

#include <memory>
#include <string>

#include "client/sdk/client.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using google::protobuf::util::MessageDifferencer;
using testing::IsOk;

template <typename Message>
Message Parsed(const std::string& text) {
  Message out;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &out)) << text;
  return out;
}

constexpr char kFields[] = R"pb(grasp_id: "top"
                                approach_distance_m: 0.1
                                gripper_opening_m: 0.04
                                priority: 3
                                retreat_distance_m: 0.05)pb";

// Answers every request with the same text.
class ScriptedServer : public v1::RecognitionService::Service {
 public:
  explicit ScriptedServer(std::string answer) : answer_(std::move(answer)) {
    grpc::ServerBuilder builder;
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }

  Client Connect() { return {server_->InProcessChannel({}), ConnectionOptions()}; }

  grpc::Status Recognize(grpc::ServerContext*, const v1::RecognizeRequest*,
                         v1::RecognizeResponse* response) override {
    *response = Parsed<v1::RecognizeResponse>(answer_);
    return grpc::Status::OK;
  }

 private:
  std::string answer_;
  std::unique_ptr<grpc::Server> server_;
};

v1::RecognizeResponse AnswerOf(const std::string& proposal) {
  ScriptedServer server("detections { grasps {" + proposal + "} }");
  const auto answer = server.Connect().Recognize({});
  EXPECT_THAT(answer, IsOk());
  return answer.ok() ? *answer : v1::RecognizeResponse();
}

TEST(EarlierServersTest, AGraspIsMadeOfTheDeprecatedFields) {
  const v1::GraspProposal proposal =
      AnswerOf(kFields + std::string(" tcp_pose { position { x: 0.3 } }")).detections(0).grasps(0);
  EXPECT_TRUE(MessageDifferencer::Equals(proposal.grasp(), Parsed<v1::Grasp>(kFields)))
      << proposal.DebugString();
  EXPECT_EQ(proposal.tcp_pose().position().x(), 0.3);
}

// A field that is not repeated for earlier clients is not lost, and one that is cannot overrule.
TEST(EarlierServersTest, TheGraspOfANewerServerIsKept) {
  const std::string grasp = R"pb(grasp_id: "top"
                                 priority: 4
                                 free_turn { max_deg: 30 })pb";
  const v1::RecognizeResponse answer = AnswerOf(std::string(kFields) + " grasp {" + grasp + "}");
  EXPECT_TRUE(
      MessageDifferencer::Equals(answer.detections(0).grasps(0).grasp(), Parsed<v1::Grasp>(grasp)))
      << answer.DebugString();
}

TEST(EarlierServersTest, EveryDeprecatedFieldIsRead) {
  const v1::GraspProposal proposal = Parsed<v1::GraspProposal>(kFields);
  const v1::Grasp grasp = TaughtGraspOf(proposal);
  const auto* descriptor = v1::GraspProposal::descriptor();
  int deprecated = 0;
  for (int i = 0; i < descriptor->field_count(); ++i) {
    if (!descriptor->field(i)->options().deprecated()) continue;
    ++deprecated;
    const auto* field = v1::Grasp::descriptor()->FindFieldByName(descriptor->field(i)->name());
    ASSERT_NE(field, nullptr) << descriptor->field(i)->name();
    std::string before;
    std::string now;
    google::protobuf::TextFormat::PrintFieldValueToString(proposal, descriptor->field(i), -1,
                                                          &before);
    google::protobuf::TextFormat::PrintFieldValueToString(grasp, field, -1, &now);
    EXPECT_EQ(now, before) << field->name();
  }
  EXPECT_EQ(deprecated, 5);
}

}  // namespace
}  // namespace graspdb::client
