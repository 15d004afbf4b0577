// Bulk uploads: UploadService.
#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include "graspdb/v1/upload_service.grpc.pb.h"
#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

constexpr char kUpload[] = "uploads/monday";

class UploadsTest : public ServerTest {
 protected:
  void SetUp() override {
    ServerTest::SetUp();
    Declare("wedge");
    Connect();
  }

  void Connect() { stub_ = v1::UploadService::NewStub(channel_); }

  template <typename Request, typename Response>
  using Method = grpc::Status (v1::UploadService::Stub::*)(grpc::ClientContext*, const Request&,
                                                           Response*);
  template <typename Request, typename Response>
  grpc::Status Send(Method<Request, Response> method, const Request& request, Response* response) {
    grpc::ClientContext context;
    return (*stub_.*method)(&context, request, response);
  }

  grpc::Status Create(std::int64_t expected = 0) {
    v1::CreateUploadRequest request;
    request.set_upload_id("monday");
    request.mutable_upload()->set_expected_view_count(expected);
    v1::Upload response;
    return Send(&v1::UploadService::Stub::CreateUpload, request, &response);
  }
  v1::Upload Get() {
    v1::GetUploadRequest request;
    request.set_name(kUpload);
    v1::Upload response;
    EXPECT_THAT(Send(&v1::UploadService::Stub::GetUpload, request, &response), IsGrpcOk());
    return response;
  }
  grpc::Status Commit(bool skip_failed, v1::Upload* response) {
    v1::CommitUploadRequest request;
    request.set_name(kUpload);
    request.set_skip_failed(skip_failed);
    return Send(&v1::UploadService::Stub::CommitUpload, request, response);
  }
  grpc::Status Delete() {
    v1::DeleteUploadRequest request;
    request.set_name(kUpload);
    google::protobuf::Empty response;
    return Send(&v1::UploadService::Stub::DeleteUpload, request, &response);
  }

  // Sends views over one stream, each after the response to the one before it.
  grpc::Status Write(const std::vector<v1::UploadViewsRequest>& views,
                     std::vector<v1::WriteUploadViewsResponse>* responses) {
    grpc::ClientContext context;
    const auto stream = stub_->WriteUploadViews(&context);
    for (const v1::UploadViewsRequest& view : views) {
      v1::WriteUploadViewsRequest request;
      request.set_upload(kUpload);
      *request.mutable_view() = view;
      v1::WriteUploadViewsResponse response;
      if (!stream->Write(request) || !stream->Read(&response)) break;
      responses->push_back(response);
    }
    stream->WritesDone();
    return stream->Finish();
  }

  std::unique_ptr<v1::UploadService::Stub> stub_;
};

TEST_F(UploadsTest, LookingForAnUploadInVainIsNoWarning) {
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "test", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  spdlog::set_level(spdlog::level::info);
  v1::GetUploadRequest request;
  request.set_name(kUpload);
  v1::Upload response;
  EXPECT_EQ(Send(&v1::UploadService::Stub::GetUpload, request, &response).error_code(),
            grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Delete().error_code(), grpc::StatusCode::NOT_FOUND);
  server_.reset();
  spdlog::set_default_logger(before);
  spdlog::set_level(spdlog::level::off);
  EXPECT_THAT(log.str(), ::testing::ContainsRegex("\\[info\\] event=call method=GetUpload "));
  EXPECT_THAT(log.str(), ::testing::ContainsRegex("\\[warning\\] event=call method=DeleteUpload "));
}

TEST_F(UploadsTest, ViewsAreRecognizedAfterTheCommitAndNotBefore) {
  ASSERT_THAT(Create(12), IsGrpcOk());
  std::vector<v1::UploadViewsRequest> views;
  views.reserve(12);
  for (int i = 0; i < 12; ++i) views.push_back(ViewOf("wedge", 30 * i, std::to_string(i)));
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write(views, &responses), IsGrpcOk());
  ASSERT_EQ(responses.size(), 12U);
  for (const auto& response : responses) {
    EXPECT_FALSE(response.has_error()) << response.DebugString();
    EXPECT_FALSE(response.existing());
  }
  v1::Upload upload = Get();
  EXPECT_EQ(upload.state(), v1::UPLOAD_STATE_OPEN);
  EXPECT_EQ(upload.staged_view_count(), 12);
  EXPECT_GT(upload.views_per_second(), 0);
  EXPECT_EQ(upload.time_left_s(), 0);
  EXPECT_EQ(Status().view_count(), 0);
  const v1::RecognizeRequest frame = RequestOf(Photograph("wedge", {.turn_deg = 10}, 7));
  EXPECT_NE(Answer(frame).status(), v1::OK);

  const std::int64_t revision = Status().catalog_revision();
  ASSERT_THAT(Commit(false, &upload), IsGrpcOk());
  EXPECT_EQ(upload.state(), v1::UPLOAD_STATE_COMMITTED);
  EXPECT_EQ(upload.created_count(), 12);
  EXPECT_EQ(upload.commit_revision(), revision + 1);
  EXPECT_EQ(Status().catalog_revision(), revision + 1);
  EXPECT_EQ(Status().view_count(), 12);
  const std::string answer = Answer(frame).SerializeAsString();
  EXPECT_EQ(Answer(frame).status(), v1::OK);
  Restart();
  EXPECT_EQ(Answer(frame).SerializeAsString(), answer);
}

TEST_F(UploadsTest, AnUploadGoesOnAfterARestart) {
  ASSERT_THAT(Create(), IsGrpcOk());
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write({ViewOf("wedge", 0, "a"), ViewOf("wedge", 60, "b")}, &responses), IsGrpcOk());
  Restart();
  Connect();
  EXPECT_EQ(Get().staged_view_count(), 2);
  responses.clear();
  ASSERT_THAT(Write({ViewOf("wedge", 60, "b"), ViewOf("wedge", 90, "c")}, &responses), IsGrpcOk());
  EXPECT_TRUE(responses[0].existing());
  EXPECT_FALSE(responses[1].existing());
  v1::Upload upload;
  ASSERT_THAT(Commit(false, &upload), IsGrpcOk());
  EXPECT_EQ(upload.created_count(), 3);
}

TEST_F(UploadsTest, ViewsThatWereStagedWithOtherParametersAreDescribedAgain) {
  ASSERT_THAT(Create(), IsGrpcOk());
  std::vector<v1::UploadViewsRequest> views;
  views.reserve(12);
  for (int i = 0; i < 12; ++i) views.push_back(ViewOf("wedge", 30 * i, std::to_string(i)));
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write({views.begin(), views.begin() + 6}, &responses), IsGrpcOk());
  options_.normal_radius_m = 0.012;
  Restart();
  Connect();
  ASSERT_THAT(Write(views, &responses), IsGrpcOk());  // six of them are staged already
  v1::Upload upload;
  ASSERT_THAT(Commit(false, &upload), IsGrpcOk());
  EXPECT_EQ(upload.created_count(), 12);
  EXPECT_EQ(Status().left_out_record_count(), 0);
  EXPECT_EQ(Answer(RequestOf(Photograph("wedge", {.turn_deg = 10}, 7))).status(), v1::OK);
  EXPECT_EQ(Status().catalog_revision(), upload.commit_revision());
}

TEST_F(UploadsTest, StagedViewsThatCannotBeDescribedAgainDoNotPreventTheNextStart) {
  ASSERT_THAT(Create(), IsGrpcOk());
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write({ViewOf("wedge", 0, "a"), ViewOf("wedge", 30, "b")}, &responses), IsGrpcOk());
  options_.voxel_size_m = 0.1;
  Restart();
  Connect();
  v1::Upload upload;
  ASSERT_THAT(Commit(false, &upload), IsGrpcOk());
  EXPECT_EQ(Status().left_out_record_count(), 2);
  Restart();
  EXPECT_EQ(Status().left_out_record_count(), 2);
  options_.voxel_size_m = 0.003;
  Restart();
  EXPECT_EQ(Status().left_out_record_count(), 0);
}

TEST_F(UploadsTest, AViewThatCannotBeTaughtIsReportedAndTheStreamGoesOn) {
  ASSERT_THAT(Create(), IsGrpcOk());
  v1::UploadViewsRequest bad = ViewOf("wedge", 0, "bad");
  bad.mutable_view()->mutable_cloud()->set_point_stride(7);
  v1::UploadViewsRequest unnamed = ViewOf("wedge", 0, "a/b");
  v1::UploadViewsRequest orphan = ViewOf("wedge", 0, "orphan");
  orphan.set_parent("objects/wedge/stablePoses/upright");
  v1::UploadViewsRequest long_name = ViewOf("wedge", 0, std::string(300, 'a'));
  v1::UploadViewsRequest many_fields = ViewOf("wedge", 0, "many");
  for (int i = 0; i < 65; ++i) many_fields.mutable_view()->mutable_cloud()->add_fields();
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write({bad, unnamed, orphan, ViewOf("wedge", 60, "good"), long_name, many_fields},
                    &responses),
              IsGrpcOk());
  ASSERT_EQ(responses.size(), 6U);
  EXPECT_EQ(responses[0].error().code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(responses[0].error().message(), ::testing::HasSubstr("view.cloud.data"));
  EXPECT_EQ(responses[1].error().code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(responses[1].view(), "");
  EXPECT_EQ(responses[2].error().code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_FALSE(responses[3].has_error());
  EXPECT_EQ(responses[4].view(), "");
  EXPECT_THAT(responses[4].error().message(), ::testing::HasSubstr("view_id"));
  EXPECT_THAT(responses[5].error().message(), ::testing::HasSubstr("view.cloud.fields"));
  EXPECT_EQ(Get().failed_view_count(), 3);

  v1::ListUploadViewsRequest list;
  list.set_parent(kUpload);
  list.set_page_size(1);
  v1::ListUploadViewsResponse page;
  ASSERT_THAT(Send(&v1::UploadService::Stub::ListUploadViews, list, &page), IsGrpcOk());
  ASSERT_EQ(page.views_size(), 1);
  EXPECT_EQ(page.views(0).name(), FlatPoseOf("wedge") + "/views/bad");
  EXPECT_EQ(page.views(0).error().code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_FALSE(page.next_page_token().empty());

  v1::Upload upload;
  ExpectError(Commit(false, &upload), grpc::StatusCode::FAILED_PRECONDITION, "views/bad");
  ASSERT_THAT(Commit(true, &upload), IsGrpcOk());
  EXPECT_EQ(upload.created_count(), 1);
  EXPECT_EQ(upload.failed_view_count(), 3);
}

TEST_F(UploadsTest, ViewsThatCannotBeTaughtCountInTheRate) {
  ASSERT_THAT(Create(2), IsGrpcOk());
  v1::UploadViewsRequest bad = ViewOf("wedge", 0, "bad");
  bad.mutable_view()->mutable_cloud()->set_point_stride(7);
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write({bad}, &responses), IsGrpcOk());
  EXPECT_GT(Get().views_per_second(), 0);
  EXPECT_GT(Get().time_left_s(), 0);
}

TEST_F(UploadsTest, AViewThatTheCatalogueHasReplacesItsError) {
  const v1::UploadViewsRequest good = ViewOf("wedge", 0, "a");
  v1::UploadViewsRequest bad = good;
  bad.mutable_view()->mutable_cloud()->set_point_stride(7);
  ASSERT_THAT(Create(), IsGrpcOk());
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write({bad}, &responses), IsGrpcOk());
  EXPECT_EQ(Get().failed_view_count(), 1);
  ASSERT_THAT(Upload(good), IsGrpcOk());
  ASSERT_THAT(Write({good}, &responses), IsGrpcOk());
  ASSERT_EQ(responses.size(), 2U);
  EXPECT_FALSE(responses[1].has_error());
  EXPECT_EQ(Get().failed_view_count(), 0);
  v1::Upload upload;
  ASSERT_THAT(Commit(false, &upload), IsGrpcOk());
  EXPECT_EQ(upload.existing_count(), 1);
}

TEST_F(UploadsTest, AStreamToNoOpenUploadEnds) {
  std::vector<v1::WriteUploadViewsResponse> responses;
  ExpectError(Write({ViewOf("wedge", 0, "a")}, &responses), grpc::StatusCode::NOT_FOUND, kUpload);
  ASSERT_THAT(Create(), IsGrpcOk());
  v1::Upload upload;
  ASSERT_THAT(Commit(false, &upload), IsGrpcOk());
  ExpectError(Write({ViewOf("wedge", 0, "a")}, &responses), grpc::StatusCode::FAILED_PRECONDITION,
              kUpload);
  EXPECT_TRUE(responses.empty());
}

TEST_F(UploadsTest, AStreamDoesNotGoOnInTheNextUploadOfTheName) {
  ASSERT_THAT(Create(), IsGrpcOk());
  grpc::ClientContext context;
  const auto stream = stub_->WriteUploadViews(&context);
  v1::WriteUploadViewsRequest request;
  request.set_upload(kUpload);
  *request.mutable_view() = ViewOf("wedge", 0, "a");
  v1::WriteUploadViewsResponse response;
  ASSERT_TRUE(stream->Write(request) && stream->Read(&response));
  ASSERT_THAT(Delete(), IsGrpcOk());
  ASSERT_THAT(Create(), IsGrpcOk());
  EXPECT_TRUE(stream->Write(request));
  EXPECT_FALSE(stream->Read(&response));
  ExpectError(stream->Finish(), grpc::StatusCode::ABORTED, kUpload);
  EXPECT_EQ(Get().staged_view_count(), 0);
}

TEST_F(UploadsTest, AnAbandonedUploadIsDeletedWithItsViews) {
  ASSERT_THAT(Create(), IsGrpcOk());
  std::vector<v1::WriteUploadViewsResponse> responses;
  ASSERT_THAT(Write({ViewOf("wedge", 0, "a")}, &responses), IsGrpcOk());
  ASSERT_THAT(Delete(), IsGrpcOk());
  v1::ListUploadsResponse list;
  ASSERT_THAT(Send(&v1::UploadService::Stub::ListUploads, v1::ListUploadsRequest(), &list),
              IsGrpcOk());
  EXPECT_EQ(list.uploads_size(), 0);
  ASSERT_THAT(Create(), IsGrpcOk());
  EXPECT_EQ(Get().staged_view_count(), 0);
}

}  // namespace
}  // namespace graspdb::testing
