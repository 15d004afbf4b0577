// Fields of requests that exceed their limits are rejected, with their path, in every method;
// records from before the limits stay accessible.
#include "server/requests/request_limits.h"

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/dynamic_message.h>
#include <grpcpp/create_channel.h>

#include <functional>

#include "storage/catalogue/catalogue.h"
#include "tests/server/raw_call.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::MethodDescriptor;

constexpr int kFarTooMany = 100'000;

// Calls `visit` with the path of every string and every repeated field below `at`, while only that
// field exceeds its limit.
void ForEachOverlong(Message& at, const std::string& path,
                     const std::function<void(const std::string&)>& visit) {
  const google::protobuf::Reflection& access = *at.GetReflection();
  for (int i = 0; i < at.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor& field = *at.GetDescriptor()->field(i);
    const std::string here = path + field.name();
    const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    const bool is_number = field.cpp_type() == FieldDescriptor::CPPTYPE_FLOAT;
    if (field.is_repeated()) {
      for (int n = 0; n < kFarTooMany; ++n) {
        if (is_message) {
          access.AddMessage(&at, &field);
        } else if (is_number) {
          access.AddFloat(&at, &field, 1);
        } else {
          access.AddString(&at, &field, "a");
        }
      }
      visit(here);
      access.ClearField(&at, &field);
      if (is_number) continue;
      if (is_message) {
        ForEachOverlong(*access.AddMessage(&at, &field), here + "[0].", visit);
      } else {
        access.AddString(&at, &field, std::string(kFarTooMany, 'a'));
        visit(here + "[0]");
      }
    } else if (is_message) {
      ForEachOverlong(*access.MutableMessage(&at, &field), here + ".", visit);
    } else if (field.type() == FieldDescriptor::TYPE_STRING) {
      access.SetString(&at, &field, std::string(kFarTooMany, 'a'));
      visit(here);
    }
    access.ClearField(&at, &field);
  }
}

class RequestLimitsTest : public ServerTest {
 protected:
  // Every string and every repeated field of the method's request; returns their number.
  int CheckEveryField(const MethodDescriptor& method) {
    const std::string name = "/" + method.service()->full_name() + "/" + method.name();
    google::protobuf::DynamicMessageFactory factory;
    const std::unique_ptr<Message> request(factory.GetPrototype(method.input_type())->New());
    int count = 0;
    ForEachOverlong(*request, "", [&](const std::string& path) {
      SCOPED_TRACE(name + " " + path);
      RawCall call(channel_, name);
      call.Write(request->SerializeAsString());
      ExpectBadField(call.Finish(), path, "send at most");
      ++count;
    });
    return count;
  }

  // Stores objects with names of 40 MB, bypassing the server.
  void StoreHugeObjects() {
    server_.reset();
    auto catalogue = storage::Catalogue::Open(options_.database);
    ASSERT_THAT(catalogue, IsOk());
    for (const char* name : {"objects/a", "objects/b", "objects/c"}) {
      v1::Object object;
      object.set_name(name);
      object.mutable_display_name()->resize(40'000'000, 'x');
      ASSERT_THAT((*catalogue)->CreateObject(object), IsOk());
    }
    catalogue->reset();
    Start();
  }
};

TEST_F(RequestLimitsTest, EveryStringAndEveryListOfEveryRequestHasALimit) {
  int fields = 0;
  for (const auto* file :
       {v1::CreateObjectRequest::descriptor()->file(), v1::CreateCellRequest::descriptor()->file(),
        v1::RecognizeRequest::descriptor()->file()}) {
    for (int m = 0; m < file->service(0)->method_count(); ++m) {
      const MethodDescriptor& method = *file->service(0)->method(m);
      // Returns errors within its stream, see below.
      if (method.name() != "RecognizeStream") fields += CheckEveryField(method);
    }
  }
  EXPECT_GT(fields, 60);
}

TEST_F(RequestLimitsTest, FrameOfAStreamGetsTheField) {
  const auto stub = v1::RecognitionService::NewStub(channel_);
  grpc::ClientContext context;
  const auto stream = stub->RecognizeStream(&context);
  v1::RecognizeStreamRequest frame;
  frame.set_frame_id(std::string(kFarTooMany, 'a'));
  stream->Write(frame);
  v1::RecognizeStreamResponse answer;
  ASSERT_TRUE(stream->Read(&answer));
  EXPECT_THAT(answer.error().message(), ::testing::StartsWith("frame_id: "));
  EXPECT_LE(answer.ByteSizeLong(), 4096U);
  frame.set_frame_id("b");
  frame.mutable_request()->set_cell(std::string(kFarTooMany, 'a'));
  stream->Write(frame);
  ASSERT_TRUE(stream->Read(&answer));
  EXPECT_THAT(answer.error().message(), ::testing::StartsWith("cell: has 100000 bytes"));
  EXPECT_EQ(answer.frame_id(), "b");
  stream->WritesDone();
  EXPECT_THAT(stream->Finish(), IsGrpcOk());
}

TEST_F(RequestLimitsTest, MaximumSizesAreAccepted) {
  v1::CreateObjectRequest request;
  request.set_object_id(std::string(63, 'o'));
  request.mutable_object()->set_display_name(std::string(server::kMaxNameBytes, 'n'));
  for (int i = 0; i < 32; ++i) request.mutable_object()->add_labels("l" + std::to_string(i));
  EXPECT_THAT(Call(&Catalog::CreateObject, request), IsGrpcOk());
  request.set_object_id("o");
  request.mutable_object()->mutable_display_name()->push_back('n');
  ExpectBadField(Call(&Catalog::CreateObject, request), "object.display_name", "at most 256");
}

TEST_F(RequestLimitsTest, UnknownFieldsAreNotStored) {
  v1::CreateObjectRequest request;
  request.set_object_id("a");
  v1::Object* object = request.mutable_object();
  object->GetReflection()->MutableUnknownFields(object)->AddLengthDelimited(
      1000, std::string(kFarTooMany, 'x'));
  EXPECT_THAT(Call(&Catalog::CreateObject, request), IsGrpcOk());
  server_.reset();
  const auto catalogue = storage::Catalogue::Open(options_.database);
  ASSERT_THAT(catalogue, IsOk());
  EXPECT_LT((*catalogue)->GetObject("objects/a")->ByteSizeLong(), 100U);
}

TEST_F(RequestLimitsTest, OldHugeRecordsCanBeListedAndDeleted) {
  StoreHugeObjects();
  // With gRPC's own limit on responses, 4 MB.
  const auto stub = v1::CatalogService::NewStub(
      grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials()));
  std::vector<std::string> names;
  v1::ListObjectsRequest request;
  v1::ListObjectsResponse page;
  do {
    grpc::ClientContext context;
    ASSERT_THAT(stub->ListObjects(&context, request, &page), IsGrpcOk());
    for (const v1::Object& object : page.objects()) {
      names.push_back(object.name());
      EXPECT_LE(object.display_name().size(), server::kMaxNameBytes);
    }
    request.set_page_token(page.next_page_token());
  } while (!page.next_page_token().empty());
  EXPECT_THAT(names, ::testing::ElementsAre("objects/a", "objects/b", "objects/c"));
  for (const std::string& name : names) {
    v1::DeleteObjectRequest deletion;
    deletion.set_name(name);
    EXPECT_THAT(Call(&Catalog::DeleteObject, deletion), IsGrpcOk());
  }
}

}  // namespace
}  // namespace graspdb::testing
