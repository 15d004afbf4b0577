// RecognizeStream.
#include <gmock/gmock.h>

#include <thread>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

class RecognizeStreamTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    stub_ = v1::RecognitionService::NewStub(channel_);
  }

  static v1::RecognizeStreamRequest FrameOf(const std::string& id,
                                            const v1::RecognizeRequest& request) {
    v1::RecognizeStreamRequest out;
    out.set_frame_id(id);
    *out.mutable_request() = request;
    return out;
  }

  std::unique_ptr<v1::RecognitionService::Stub> stub_;
};

TEST_F(RecognizeStreamTest, FramesGetTheResponsesOfSingleCallsInOrder) {
  Teach("wedge", 2);
  std::vector<v1::RecognizeRequest> requests;
  requests.reserve(4);
  for (int i = 0; i < 4; ++i) {
    requests.push_back(RequestOf(Photograph("wedge", {.turn_deg = 20.0 * i}, 3)));
  }
  grpc::ClientContext context;
  auto stream = stub_->RecognizeStream(&context);
  std::thread writer([&] {
    for (std::size_t i = 0; i < requests.size(); ++i) {
      EXPECT_TRUE(stream->Write(FrameOf(std::to_string(i), requests[i])));
    }
    stream->WritesDone();
  });
  v1::RecognizeStreamResponse answer;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    EXPECT_TRUE(stream->Read(&answer));
    EXPECT_EQ(answer.frame_id(), std::to_string(i));
    EXPECT_EQ(answer.response().SerializeAsString(), Answer(requests[i]).SerializeAsString());
  }
  EXPECT_FALSE(stream->Read(&answer));
  writer.join();
  EXPECT_THAT(stream->Finish(), IsGrpcOk());
}

TEST_F(RecognizeStreamTest, InvalidFrameGetsAnErrorAndTheStreamContinues) {
  const v1::RecognizeRequest good = RequestOf(PhotographEmptyTable());
  v1::RecognizeRequest bad = good;
  bad.mutable_cloud()->set_point_stride(0);
  v1::RecognizeRequest lost = good;
  lost.set_cell("cells/nowhere");
  grpc::ClientContext context;
  auto stream = stub_->RecognizeStream(&context);
  v1::RecognizeStreamResponse answer;
  for (const v1::RecognizeRequest* request :
       std::initializer_list<const v1::RecognizeRequest*>{&bad, &lost, &good}) {
    ASSERT_TRUE(stream->Write(FrameOf("f", *request)));
    ASSERT_TRUE(stream->Read(&answer));
    EXPECT_EQ(answer.frame_id(), "f");
    if (request == &good) {
      EXPECT_EQ(answer.response().status(), v1::NO_CLUSTER);
      continue;
    }
    ASSERT_TRUE(answer.has_error());
    const grpc::Status error(static_cast<grpc::StatusCode>(answer.error().code()),
                             answer.error().message(), answer.error().SerializeAsString());
    if (request == &bad) {
      ExpectBadField(error, "cloud.point_stride", "must lie in 1 to 4096 bytes");
    } else {
      ExpectError(error, grpc::StatusCode::NOT_FOUND, "cells/nowhere");
    }
  }
  stream->WritesDone();
  EXPECT_THAT(stream->Finish(), IsGrpcOk());
}

TEST_F(RecognizeStreamTest, StreamUsesViewsTaughtMeanwhile) {
  Declare("wedge");
  const v1::RecognizeRequest request = RequestOf(Photograph("wedge", {}, 3));
  grpc::ClientContext context;
  auto stream = stub_->RecognizeStream(&context);
  v1::RecognizeStreamResponse answer;
  ASSERT_TRUE(stream->Write(FrameOf("before", request)));
  ASSERT_TRUE(stream->Read(&answer));
  EXPECT_EQ(answer.response().status(), v1::UNKNOWN_OBJECT);
  ASSERT_THAT(Upload(ViewOf("wedge", 0, "a")), IsGrpcOk());
  ASSERT_TRUE(stream->Write(FrameOf("after", request)));
  ASSERT_TRUE(stream->Read(&answer));
  EXPECT_EQ(answer.response().status(), v1::OK);
  stream->WritesDone();
  EXPECT_THAT(stream->Finish(), IsGrpcOk());
}

TEST_F(RecognizeStreamTest, ServerContinuesAfterACancelledStream) {
  grpc::ClientContext context;
  auto stream = stub_->RecognizeStream(&context);
  ASSERT_TRUE(stream->Write(FrameOf("1", RequestOf(PhotographEmptyTable()))));
  context.TryCancel();
  EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_EQ(Answer(RequestOf(PhotographEmptyTable())).status(), v1::NO_CLUSTER);
}

}  // namespace
}  // namespace graspdb::testing
