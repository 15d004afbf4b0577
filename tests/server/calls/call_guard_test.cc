// Identities and roles of calls.
#include "server/calls/call_guard.h"

#include <gmock/gmock.h>
#include <google/protobuf/unknown_field_set.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include "absl/time/clock.h"
#include "server/access/method_role.h"
#include "tests/server/access_fixture.h"
#include "tests/server/raw_call.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using google::protobuf::MethodDescriptor;
using grpc::StatusCode;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Property;

auto IsRefused(StatusCode code, const std::string& words) {
  return AllOf(Property("code", &grpc::Status::error_code, code),
               Property("message", &grpc::Status::error_message, HasSubstr(words)));
}

// The values of the field of that number, of a message without generated code.
std::vector<std::string> Values(const std::string& message, int number) {
  google::protobuf::UnknownFieldSet fields;
  EXPECT_TRUE(fields.ParseFromString(message));
  std::vector<std::string> out;
  for (int i = 0; i < fields.field_count(); ++i) {
    if (fields.field(i).number() == number) out.push_back(fields.field(i).length_delimited());
  }
  return out;
}

class CallGuardTest : public AccessTest {
 protected:
  // Services of the server, by its reflection service.
  std::vector<std::string> Services() {
    RawCall call(channel_, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo");
    EXPECT_TRUE(call.Write(std::string("\x3a\x00", 2)));  // ServerReflectionRequest.list_services
    std::vector<std::string> out;
    for (const std::string& list : Values(call.Read().value_or(""), 6)) {
      for (const std::string& service : Values(list, 1)) out.push_back(Values(service, 1).at(0));
    }
    return out;
  }

  // All methods that are not gRPC's own.
  std::vector<const MethodDescriptor*> Methods() {
    std::vector<const MethodDescriptor*> out;
    for (const std::string& name : Services()) {
      if (name.starts_with("grpc.")) continue;
      const auto* service =
          google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(name);
      for (int i = 0; i < service->method_count(); ++i) out.push_back(service->method(i));
    }
    return out;
  }

  // The result of a call with an empty request.
  grpc::Status CallAs(const MethodDescriptor& method, const std::vector<std::string>& tokens) {
    RawCall call(channel_, "/" + method.service()->full_name() + "/" + method.name(), tokens);
    call.Write("");
    call.WritesDone();
    if (call.Read()) call.Cancel();  // some calls would not end
    return call.Finish();
  }
};

TEST_F(CallGuardTest, EveryMethodTakesItsRole) {
  server_.reset();                         // so that the file is read once
  std::map<v1::Role, std::string> only;    // tokens with one role
  std::map<v1::Role, std::string> others;  // with all others but admin
  for (int own = v1::ROLE_READ; own <= v1::ROLE_ADMIN; ++own) {
    const auto role = static_cast<v1::Role>(own);
    std::vector<v1::Role> rest = {v1::ROLE_READ, v1::ROLE_RECOGNISE, v1::ROLE_TEACH,
                                  v1::ROLE_OPERATE};
    std::erase(rest, role);
    only[role] = Add("only-" + server::RoleName(role), {role});
    others[role] = Add("all-but-" + server::RoleName(role), rest);
  }
  Start();
  const std::vector<const MethodDescriptor*> methods = Methods();
  ASSERT_GE(methods.size(), 25U);
  for (const MethodDescriptor* method : methods) {
    SCOPED_TRACE(method->full_name());
    const v1::Role role = server::RoleOf(*method);
    ASSERT_NE(role, v1::ROLE_UNSPECIFIED) << "give it an option (role) in the proto";
    EXPECT_THAT(CallAs(*method, {}), IsRefused(StatusCode::UNAUTHENTICATED, "--token-file"));
    EXPECT_THAT(
        CallAs(*method, {others[role]}),
        IsRefused(StatusCode::PERMISSION_DENIED, "lacks the role " + server::RoleName(role) +
                                                     ", which " + method->name() + " takes"));
    for (const v1::Role allowed : {role, v1::ROLE_ADMIN}) {
      const StatusCode code = CallAs(*method, {only[allowed]}).error_code();
      EXPECT_NE(code, StatusCode::PERMISSION_DENIED);
      EXPECT_NE(code, StatusCode::UNAUTHENTICATED);
    }
  }
}

TEST_F(CallGuardTest, HealthAndReflectionAreOpen) {
  EXPECT_THAT(Services(), ::testing::Contains("grpc.health.v1.Health"));
  RawCall check(channel_, "/grpc.health.v1.Health/Check");
  ASSERT_TRUE(check.Write(""));
  EXPECT_EQ(check.Read(), "\x08\x01");  // SERVING
}

TEST_F(CallGuardTest, UnknownAndSeveralTokensAreRefused) {
  const MethodDescriptor& method = *Methods().front();
  EXPECT_THAT(StatusAs("graspdb_unknown"),
              IsRefused(StatusCode::UNAUTHENTICATED, "the token is unknown"));
  EXPECT_THAT(CallAs(method, {token_, token_}),
              IsRefused(StatusCode::UNAUTHENTICATED, "several tokens"));
  EXPECT_THAT(StatusAs(std::string(7000, 'x')),
              IsRefused(StatusCode::UNAUTHENTICATED, "the token is unknown"));
}

TEST_F(CallGuardTest, ARevokedTokenIsRefusedAndOthersStay) {
  const std::string reader = Add("reader", {v1::ROLE_READ});
  EXPECT_THAT(StatusAs(reader), IsGrpcOk());
  Remove("reader");
  EXPECT_THAT(StatusAs(reader), IsRefused(StatusCode::UNAUTHENTICATED, "revoked"));
  EXPECT_THAT(StatusAs(token_), IsGrpcOk());
}

TEST_F(CallGuardTest, AStreamIsRefusedFromTheNextFrameOnAfterRevocation) {
  const std::string robot = Add("robot", {v1::ROLE_READ, v1::ROLE_RECOGNISE});
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer " + robot);
  const auto stub = v1::RecognitionService::NewStub(channel_);
  const auto stream = stub->RecognizeStream(&context);
  v1::RecognizeStreamResponse answer;
  ASSERT_TRUE(stream->Write({}) && stream->Read(&answer));
  EXPECT_EQ(answer.error().code(), StatusCode::INVALID_ARGUMENT);
  Remove("robot");
  ASSERT_TRUE(stream->Write({}) && stream->Read(&answer));
  EXPECT_EQ(answer.error().code(), StatusCode::UNAUTHENTICATED);
  stream->WritesDone();
  EXPECT_THAT(stream->Finish(), IsGrpcOk());
}

TEST_F(CallGuardTest, AWrongFileKeepsTheIdentities) {
  const auto log = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(16);
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("captured", log));
  const std::string reader = Add("reader", {v1::ROLE_READ});
  WriteIdentities("{\"name\":\"reader\"}\n");
  const auto is_logged = [&] {
    return std::ranges::any_of(log->last_formatted(), [](const std::string& line) {
      return line.find("identities_invalid") != std::string::npos;
    });
  };
  while (!is_logged()) absl::SleepFor(absl::Milliseconds(20));
  EXPECT_THAT(StatusAs(reader), IsGrpcOk());
  spdlog::set_default_logger(before);
}

TEST_F(CallGuardTest, AWrongFileIsRejectedAtTheStart) {
  WriteIdentities("{\"name\":\"reader\"}\n");
  server_.reset();
  EXPECT_THAT(server::Server::Start(options_),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("line 1: roles")));
  WriteIdentities("# no identity\n");
  EXPECT_THAT(server::Server::Start(options_),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("has no identity")));
  options_.identities += ".missing";
  EXPECT_THAT(server::Server::Start(options_),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("cannot read")));
}

class CellOfCallerTest : public AccessTest {
 protected:
  void SetUp() override {
    AccessTest::SetUp();
    for (const char* id : {"press-3", "press-4"}) {
      v1::CreateCellRequest request;
      request.set_cell_id(id);
      ASSERT_THAT(Call(&Cells::CreateCell, request), IsGrpcOk());
    }
    token_ = Add("agent", {v1::ROLE_READ, v1::ROLE_RECOGNISE, v1::ROLE_OPERATE}, "cells/press-3");
  }

  grpc::Status Recognize(const std::string& cell) {
    v1::RecognizeRequest request;
    request.set_cell(cell);
    return Call(&Recognition::Recognize, request);
  }
};

TEST_F(CellOfCallerTest, OnlyThatCellIsUsed) {
  EXPECT_EQ(Recognize("cells/press-3").error_code(), StatusCode::INVALID_ARGUMENT);  // no scan
  EXPECT_THAT(Recognize("cells/press-4"),
              IsRefused(StatusCode::PERMISSION_DENIED,
                        "agent may use cells/press-3 only, not cells/press-4"));
  EXPECT_THAT(Recognize(""), IsRefused(StatusCode::PERMISSION_DENIED, "not all cells"));
}

TEST_F(CellOfCallerTest, FramesOfAStreamToo) {
  grpc::ClientContext context;
  context.AddMetadata("authorization", "Bearer " + token_);
  const auto stub = v1::RecognitionService::NewStub(channel_);
  const auto stream = stub->RecognizeStream(&context);
  v1::RecognizeStreamRequest frame;
  frame.mutable_request()->set_cell("cells/press-4");
  v1::RecognizeStreamResponse answer;
  ASSERT_TRUE(stream->Write(frame) && stream->Read(&answer));
  EXPECT_EQ(answer.error().code(), StatusCode::PERMISSION_DENIED);
}

TEST_F(CellOfCallerTest, OnlyThatCellIsReadAndChanged) {
  v1::GetCellRequest get;
  get.set_name("cells/press-3");
  EXPECT_THAT(Call(&Cells::GetCell, get), IsGrpcOk());
  v1::UpdateCellRequest update;
  update.mutable_cell()->set_name("cells/press-3");
  EXPECT_THAT(Call(&Cells::UpdateCell, update), IsGrpcOk());
  for (const char* other : {"cells/press-4", "press-3", ""}) {
    SCOPED_TRACE(other);
    get.set_name(other);
    EXPECT_THAT(Call(&Cells::GetCell, get), IsRefused(StatusCode::PERMISSION_DENIED, "only"));
    update.mutable_cell()->set_name(other);
    EXPECT_THAT(Call(&Cells::UpdateCell, update), IsRefused(StatusCode::PERMISSION_DENIED, "only"));
    v1::DeleteCellRequest deletion;
    deletion.set_name(other);
    EXPECT_THAT(Call(&Cells::DeleteCell, deletion),
                IsRefused(StatusCode::PERMISSION_DENIED, "only"));
  }
  v1::CreateCellRequest creation;
  creation.set_cell_id("press-5");
  EXPECT_THAT(Call(&Cells::CreateCell, creation), IsRefused(StatusCode::PERMISSION_DENIED, "only"));
  EXPECT_THAT(Call(&Cells::ListCells, v1::ListCellsRequest()),
              IsRefused(StatusCode::PERMISSION_DENIED, "not all cells"));
}

TEST_F(CellOfCallerTest, OutcomesAreReportedForThatCellOrWithoutOne) {
  v1::ReportGraspOutcomeRequest report;
  report.set_name("objects/o/stablePoses/p");
  report.set_outcome(v1::GRASP_OUTCOME_PICKED);
  EXPECT_EQ(Call(&Catalog::ReportGraspOutcome, report).error_code(), StatusCode::NOT_FOUND);
  report.set_cell("cells/press-4");
  EXPECT_THAT(Call(&Catalog::ReportGraspOutcome, report),
              IsRefused(StatusCode::PERMISSION_DENIED, "only"));
}

TEST_F(CellOfCallerTest, TheCatalogueIsRead) {
  EXPECT_THAT(Call(&Catalog::ListObjects, v1::ListObjectsRequest()), IsGrpcOk());
}

}  // namespace
}  // namespace graspdb::testing
