// Invalid requests to the catalogue and the cells: each gets its code, its field and a
// sentence, and changes nothing.
#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <ostream>

#include "tests/server/server_fixture.h"

namespace graspdb::testing {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr auto kInvalid = grpc::StatusCode::INVALID_ARGUMENT;
constexpr auto kNotFound = grpc::StatusCode::NOT_FOUND;

struct BadRequest;

class BadRequestTest : public ServerTest, public ::testing::WithParamInterface<BadRequest> {
 public:
  template <typename Method, typename Request>
  grpc::Status Send(Method method, const Request& request) {
    return Call(method, request);
  }
  using ServerTest::Catalog;
  using ServerTest::Cells;
};

struct BadRequest {
  std::string name;
  std::function<grpc::Status(BadRequestTest&)> send;
  grpc::StatusCode code;
  std::string field;  // for INVALID_ARGUMENT
  std::string words;
};

void PrintTo(const BadRequest& bad, std::ostream* out) { *out << bad.name; }

using Catalog = v1::CatalogService::Stub;
using Cells = v1::CellService::Stub;
using Test = BadRequestTest;

// A case with a default request, modified by `fill`.
template <typename Request, typename Response>
BadRequest Catalogue(const std::string& name,
                     grpc::Status (Catalog::*method)(grpc::ClientContext*, const Request&,
                                                     Response*),
                     const std::function<void(Request&)>& fill, grpc::StatusCode code,
                     const std::string& field, const std::string& words) {
  return {name,
          [=](Test& test) {
            Request request;
            fill(request);
            return test.Send(method, request);
          },
          code, field, words};
}

BadRequest StablePose(const std::string& name, const std::function<void(v1::StablePose&)>& fill,
                      const std::string& field, const std::string& words) {
  return Catalogue<v1::CreateStablePoseRequest>(
      name, &Catalog::CreateStablePose,
      [=](v1::CreateStablePoseRequest& request) {
        request.set_parent("objects/wedge");
        request.set_stable_pose_id("new");
        v1::Grasp* grasp = request.mutable_stable_pose()->add_grasps();
        *grasp = Part("wedge").grasps[0];
        fill(*request.mutable_stable_pose());
      },
      kInvalid, "stable_pose." + field, words);
}

TEST_P(BadRequestTest, IsRejectedWithASentenceAndChangesNothing) {
  Declare("wedge");
  const std::int64_t revision = Status().catalog_revision();
  const BadRequest& bad = GetParam();
  const grpc::Status status = bad.send(*this);
  if (bad.code == kInvalid) {
    ExpectBadField(status, bad.field, bad.words);
  } else {
    ExpectError(status, bad.code, bad.words);
  }
  EXPECT_EQ(Status().catalog_revision(), revision);
}

std::vector<BadRequest> NameCases() {
  return {
      Catalogue<v1::CreateObjectRequest>(
          "ObjectWithoutId", &Catalog::CreateObject, [](auto&) {}, kInvalid, "object_id",
          "1 to 63"),
      Catalogue<v1::CreateObjectRequest>(
          "ObjectIdWithSlash", &Catalog::CreateObject, [](auto& r) { r.set_object_id("a/b"); },
          kInvalid, "object_id", "a/b"),
      Catalogue<v1::CreateObjectRequest>(
          "ObjectIdTooLong", &Catalog::CreateObject,
          [](auto& r) { r.set_object_id(std::string(64, 'a')); }, kInvalid, "object_id", "1 to 63"),
      Catalogue<v1::GetObjectRequest>(
          "EmptyName", &Catalog::GetObject, [](auto&) {}, kInvalid, "name", "objects/{object}"),
      Catalogue<v1::GetObjectRequest>(
          "NameOfAnotherKind", &Catalog::GetObject, [](auto& r) { r.set_name("cells/press"); },
          kInvalid, "name", "cells/press"),
      Catalogue<v1::GetObjectRequest>(
          "NameThatClimbs", &Catalog::GetObject, [](auto& r) { r.set_name("objects/../x"); },
          kInvalid, "name", "objects/../x"),
      Catalogue<v1::GetObjectRequest>(
          "UnknownObject", &Catalog::GetObject, [](auto& r) { r.set_name("objects/mug"); },
          kNotFound, "", "objects/mug"),
      Catalogue<v1::UpdateObjectRequest>(
          "UpdateWithoutObject", &Catalog::UpdateObject, [](auto&) {}, kInvalid, "object.name",
          "objects/{object}"),
      Catalogue<v1::DeleteObjectRequest>(
          "DeleteWithoutName", &Catalog::DeleteObject, [](auto&) {}, kInvalid, "name",
          "objects/{object}"),
      Catalogue<v1::CreateStablePoseRequest>(
          "StablePoseWithoutParent", &Catalog::CreateStablePose, [](auto&) {}, kInvalid, "parent",
          "objects/{object}"),
      Catalogue<v1::CreateStablePoseRequest>(
          "StablePoseIdWithSpace", &Catalog::CreateStablePose,
          [](auto& r) {
            r.set_parent("objects/wedge");
            r.set_stable_pose_id("on its side");
          },
          kInvalid, "stable_pose_id", "on its side"),
      Catalogue<v1::GetStablePoseRequest>(
          "StablePoseNameTooShort", &Catalog::GetStablePose,
          [](auto& r) { r.set_name("objects/wedge"); }, kInvalid, "name", "objects/wedge"),
      Catalogue<v1::UpdateStablePoseRequest>(
          "UpdateOfAMalformedStablePose", &Catalog::UpdateStablePose,
          [](auto& r) { r.mutable_stable_pose()->set_name("wedge"); }, kInvalid, "stable_pose.name",
          "\"wedge\""),
      Catalogue<v1::DeleteStablePoseRequest>(
          "DeleteOfAMalformedStablePose", &Catalog::DeleteStablePose,
          [](auto& r) { r.set_name("x"); }, kInvalid, "name", "\"x\""),
      Catalogue<v1::GetViewRequest>(
          "MalformedView", &Catalog::GetView, [](auto& r) { r.set_name("objects/wedge/views/a"); },
          kInvalid, "name", "objects/wedge/views/a"),
      Catalogue<v1::DeleteViewRequest>(
          "DeleteOfAMalformedView", &Catalog::DeleteView, [](auto&) {}, kInvalid, "name",
          "views/{view}"),
      {"MalformedCellName",
       [](Test& test) {
         v1::GetCellRequest request;
         request.set_name("press");
         return test.Send(&Cells::GetCell, request);
       },
       kInvalid, "name", "\"press\""},
      {"UpdateOfAMalformedCell",
       [](Test& test) { return test.Send(&Cells::UpdateCell, v1::UpdateCellRequest()); }, kInvalid,
       "cell.name", "cells/{cell}"},
      {"DeleteOfAMalformedCell",
       [](Test& test) { return test.Send(&Cells::DeleteCell, v1::DeleteCellRequest()); }, kInvalid,
       "name", "cells/{cell}"},
      {"MalformedCellId",
       [](Test& test) { return test.Send(&Cells::CreateCell, v1::CreateCellRequest()); }, kInvalid,
       "cell_id", "1 to 63"},
  };
}

std::vector<BadRequest> ListCases() {
  const auto views_of_wedge = [](auto& r) { r.set_parent("objects/wedge/stablePoses/flat"); };
  return {
      Catalogue<v1::ListObjectsRequest>(
          "NegativePageSize", &Catalog::ListObjects, [](auto& r) { r.set_page_size(-1); }, kInvalid,
          "page_size", "negative"),
      Catalogue<v1::ListObjectsRequest>(
          "GarbageAsPageToken", &Catalog::ListObjects, [](auto& r) { r.set_page_token("?!"); },
          kInvalid, "page_token", "not a page token"),
      Catalogue<v1::ListObjectsRequest>(
          "PageTokenOfAnotherServer", &Catalog::ListObjects,
          [](auto& r) { r.set_page_token("Zm9v"); }, kInvalid, "page_token", "not a page token"),
      Catalogue<v1::ListViewsRequest>(
          "PageTokenOfAnotherList", &Catalog::ListViews,
          [=](auto& r) {
            views_of_wedge(r);
            r.set_page_token("b2JqZWN0cy9h");  // objects/a
          },
          kInvalid, "page_token", "not a page token"),
      Catalogue<v1::ListViewsRequest>(
          "ViewsOfAMalformedParent", &Catalog::ListViews,
          [](auto& r) { r.set_parent("objects/wedge"); }, kInvalid, "parent", "objects/wedge"),
      Catalogue<v1::ListStablePosesRequest>(
          "StablePosesWithoutParent", &Catalog::ListStablePoses, [](auto&) {}, kInvalid, "parent",
          "objects/{object}"),
      Catalogue<v1::UpdateObjectRequest>(
          "MaskOfAnUnknownField", &Catalog::UpdateObject,
          [](auto& r) {
            r.mutable_object()->set_name("objects/wedge");
            r.mutable_update_mask()->add_paths("colour");
          },
          kInvalid, "update_mask", "\"colour\""),
      Catalogue<v1::UpdateObjectRequest>(
          "MaskOfAnOutputField", &Catalog::UpdateObject,
          [](auto& r) {
            r.mutable_object()->set_name("objects/wedge");
            r.mutable_update_mask()->add_paths("create_time");
          },
          kInvalid, "update_mask", "\"create_time\""),
      Catalogue<v1::UpdateStablePoseRequest>(
          "MaskIntoARepeatedField", &Catalog::UpdateStablePose,
          [](auto& r) {
            r.mutable_stable_pose()->set_name("objects/wedge/stablePoses/flat");
            r.mutable_update_mask()->add_paths("grasps.priority");
          },
          kInvalid, "update_mask", "\"grasps.priority\""),
  };
}

std::vector<BadRequest> ContentCases() {
  using Pose = v1::StablePose;
  return {
      StablePose(
          "NegativeSymmetry", [](Pose& p) { p.set_symmetry_order(-1); }, "symmetry_order",
          "must lie in 0"),
      StablePose(
          "GraspWithoutId", [](Pose& p) { p.mutable_grasps(0)->clear_grasp_id(); },
          "grasps[0].grasp_id", "1 to 63"),
      StablePose(
          "GraspIdWithSlash", [](Pose& p) { p.mutable_grasps(0)->set_grasp_id("a/b"); },
          "grasps[0].grasp_id", "a/b"),
      StablePose(
          "TwoGraspsOfOneId", [](Pose& p) { *p.add_grasps() = p.grasps(0); }, "grasps[1].grasp_id",
          "unique"),
      StablePose(
          "TooManyGrasps",
          [](Pose& p) {
            for (int i = 0; i < 64; ++i) {
              *p.add_grasps() = p.grasps(0);
              p.mutable_grasps(i + 1)->set_grasp_id("g" + std::to_string(i));
            }
          },
          "grasps", "64"),
      StablePose(
          "GraspWithZeroQuaternion",
          [](Pose& p) { p.mutable_grasps(0)->mutable_tcp_pose()->clear_orientation(); },
          "grasps[0].tcp_pose.orientation", "unit quaternion"),
      StablePose(
          "GraspWithNegativeOpening",
          [](Pose& p) { p.mutable_grasps(0)->set_gripper_opening_m(-0.01); },
          "grasps[0].gripper_opening_m", "0 to 10 m"),
      StablePose(
          "GraspWithNanApproach",
          [](Pose& p) { p.mutable_grasps(0)->set_approach_distance_m(kNan); },
          "grasps[0].approach_distance_m", "0 to 10 m"),
      StablePose(
          "GraspWithNegativeRetreat",
          [](Pose& p) { p.mutable_grasps(0)->set_retreat_distance_m(-0.1); },
          "grasps[0].retreat_distance_m", "0 to 10 m"),
      StablePose(
          "GraspWithTurnBackwards",
          [](Pose& p) {
            p.mutable_grasps(0)->mutable_free_turn()->set_min_deg(90);
            p.mutable_grasps(0)->mutable_free_turn()->set_max_deg(-90);
          },
          "grasps[0].free_turn", "min_deg"),
      Catalogue<v1::CreateObjectRequest>(
          "LabelWithASpace", &Catalog::CreateObject,
          [](auto& r) {
            r.set_object_id("mug");
            r.mutable_object()->add_labels("hot drinks");
          },
          kInvalid, "object.labels[0]", "hot drinks"),
      Catalogue<v1::CreateObjectRequest>(
          "LabelGivenTwice", &Catalog::CreateObject,
          [](auto& r) {
            r.set_object_id("mug");
            r.mutable_object()->add_labels("cup");
            r.mutable_object()->add_labels("cup");
          },
          kInvalid, "object.labels[1]", "twice"),
  };
}

std::string RequestName(const ::testing::TestParamInfo<BadRequest>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(Names, BadRequestTest, ::testing::ValuesIn(NameCases()), RequestName);
INSTANTIATE_TEST_SUITE_P(Lists, BadRequestTest, ::testing::ValuesIn(ListCases()), RequestName);
INSTANTIATE_TEST_SUITE_P(Content, BadRequestTest, ::testing::ValuesIn(ContentCases()), RequestName);

}  // namespace
}  // namespace graspdb::testing
