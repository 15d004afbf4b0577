#include <iterator>
#include <vector>

#include "absl/strings/str_cat.h"
#include "files/archives/archive_file.h"
#include "files/capture_sets/capture_set.h"
#include "files/depth/depth_png.h"
#include "files/points/point_file.h"
#include "rendering/meshes/mesh_file.h"
#include "storage/base/little_endian.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/sample_frames.h"
#include "tests/fuzz/scratch_folder.h"
#include "tests/fuzz/seeds/seed_writer.h"
#include "tests/server/sample_captures.h"

namespace graspdb::fuzz {
namespace {

constexpr char kPart[] = "l-bracket";

std::string PcdHeader(const std::string& data) {
  return absl::StrCat(
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z normal_x normal_y normal_z rgb\nSIZE 4 4 4 4 4 4 4\n"
      "TYPE F F F F F F U\nCOUNT 1 1 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
      "VIEWPOINT 0.1 0.2 0.3 1 0 0 0\nPOINTS 2\nDATA ",
      data, "\n");
}

void WritePointFiles(const SeedWriter& out, const ScratchFolder& folder) {
  out.Write("point_file", "ascii.pcd",
            PcdHeader("ascii") + "0.1 0.2 0.3 0 0 1 255\nnan nan nan 0 0 1 0\n");
  out.Write("point_file", "binary.pcd", PcdHeader("binary") + std::string(56, '\x3e'));
  files::PointFile file;
  file.points = {{0.1F, 0.2F, 0.5F}, {0.1F, 0.2F, 0.5F}, {0, 0, 0}, {0.1F, 0.2F, 0.5F}};
  file.width = 2;
  file.height = 2;
  const std::filesystem::path path = folder.path() / "seed.pcd";
  Require(files::WritePcd(path, file).ok(), "a point file can be written");
  out.Write("point_file", "compressed.pcd", BytesOf(path));
  const std::string vertex =
      "element vertex 1\nproperty float x\nproperty double y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  out.Write("point_file", "ascii.ply",
            absl::StrCat("ply\nformat ascii 1.0\ncomment a\n", vertex, face,
                         "end_header\n0.1 0.2 0.3\n3 0 0 0\n"));
  for (const char* order : {"little", "big"}) {
    out.Write("point_file", absl::StrCat(order, ".ply"),
              absl::StrCat("ply\nformat binary_", order, "_endian 1.0\n", vertex, face,
                           "end_header\n", std::string(16, '\x3e'), "\x01", std::string(4, '\0')));
  }
}

void WriteDepthImages(const SeedWriter& out, const ScratchFolder& folder) {
  const v1::DepthImage image =
      testing::DepthImageOf(Window(testing::Photograph(kPart, {}, 1), 32, 24));
  const std::filesystem::path path = folder.path() / "seed.png";
  Require(files::WriteDepthPng(path, image).ok(), "a depth image can be written");
  out.Write("depth_image", "part.png", BytesOf(path));
  files::DepthPngCamera camera;
  camera.intrinsics = {.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
  const std::filesystem::path sidecar = folder.path() / files::kIntrinsicsFile;
  Require(files::WriteIntrinsics(sidecar, camera).ok(), "a sidecar can be written");
  out.Write("depth_image", "intrinsics.json", BytesOf(sidecar));
  out.Write("depth_image", "camera.json",
            R"({"width": 640, "height": 480, "K": [525, 0, 319, 0, 526, 239, 0, 0, 1], )"
            R"("depth": {"scale": 0.1, "invalid": [65535]}, "distortion_model": "plumb_bob", )"
            R"("D": [0.1, -0.2, 0.001, 0.002, 0.05]})");
}

void WriteMeshes(const SeedWriter& out, const ScratchFolder& folder) {
  rendering::TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const std::filesystem::path path = folder.path() / "seed.ply";
  Require(rendering::WriteMeshPly(path, mesh).ok(), "a mesh can be written");
  out.Write("mesh", "binary.ply", BytesOf(path));
  out.Write("mesh", "ascii.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
            "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  out.Write("mesh", "quad.obj", "# a square\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  out.Write("mesh", "ascii.stl",
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
            "endloop\nendfacet\nendsolid a\n");
  std::string binary(80, 'b');
  binary += std::string("\x01\0\0\0", 4);
  const float numbers[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  binary.append(reinterpret_cast<const char*>(numbers), sizeof(numbers));
  out.Write("mesh", "binary.stl", binary + std::string(2, '\0'));
}

void WriteCaptureSets(const SeedWriter& out, const ScratchFolder& folder) {
  const rendering::Workpiece& part = testing::Part(kPart);
  v1::CaptureSet set;
  auto& object = *set.add_objects();
  object.set_object_id(part.object_id);
  object.set_display_name("A bracket");
  auto& pose = *object.add_stable_poses();
  pose.set_stable_pose_id(part.stable_pose_id);
  pose.set_symmetry_order(1);
  for (const v1::Grasp& grasp : part.grasps) *pose.add_grasps() = grasp;
  const testing::Frame frame = testing::Photograph(kPart, {}, 1);
  for (const char* path : {"a-1", "a-2"}) {
    v1::Capture& capture = *set.add_captures();
    capture.set_path(path);
    capture.set_object_id(part.object_id);
    capture.set_stable_pose_id(part.stable_pose_id);
    *capture.mutable_sensor_pose() = testing::PoseMessage(frame.world_sensor);
    *capture.mutable_object_pose() = testing::PoseMessage(frame.world_object);
  }
  set.mutable_captures(0)->set_split(v1::Capture::TEACH);
  Require(files::SaveCaptureSet(folder.path(), set).ok(), "a capture set can be written");
  out.Write("capture_set", "two.json", BytesOf(folder.path() / files::kCaptureSetFile));
}

// One object with a stable pose and two views.
std::vector<v1::ArchiveRecord> ArchiveRecords() {
  const rendering::Workpiece& part = testing::Part(kPart);
  std::vector<v1::ArchiveRecord> out(6);
  out[0].mutable_header()->set_catalog_revision(5);
  const std::string name = "objects/" + part.object_id;
  out[1].mutable_object()->set_name(name);
  out[1].mutable_object()->add_labels("bin-7");
  v1::StablePose& pose = *out[2].mutable_stable_pose();
  pose.set_name(name + "/stablePoses/flat");
  for (const v1::Grasp& grasp : part.grasps) *pose.add_grasps() = grasp;
  pose.add_grasp_outcomes()->set_picked_count(3);
  for (const std::size_t i : {3U, 4U}) {
    v1::View& view = *out[i].mutable_view();
    view.set_name(absl::StrCat(pose.name(), "/views/", i));
    *view.mutable_object_pose() = testing::PoseMessage(recognition::Pose::Identity());
    *view.mutable_sensor_pose() = view.object_pose();
    *view.mutable_cloud() = testing::PackedCloud({{0.1F, 0.2F, 0.5F}, {0.1F, 0.3F, 0.5F}});
  }
  out[5].mutable_end()->set_object_count(1);
  out[5].mutable_end()->set_stable_pose_count(1);
  out[5].mutable_end()->set_view_count(2);
  return out;
}

// As written, and with records that the fuzzer packs.
void WriteArchives(const SeedWriter& out, const ScratchFolder& folder) {
  const std::filesystem::path path = folder.path() / "seed.graspdb";
  auto writer = files::ArchiveWriter::Create(path);
  Require(writer.ok(), "an archive can be begun");
  std::string plain(files::kArchiveMagic);
  for (const v1::ArchiveRecord& record : ArchiveRecords()) {
    Require(writer->Add(record).ok(), "a record can be written");
    const std::string bytes = record.SerializeAsString();
    plain += storage::ToLittleEndian(static_cast<std::uint32_t>(bytes.size()));
    plain += std::string(4, '\0') + bytes;
  }
  Require(writer->Finish().ok(), "an archive can be written");
  out.Write("archive", "packed.graspdb", BytesOf(path));
  out.Write("archive", "plain.graspdb", plain);
}

}  // namespace

void WriteFileSeeds(const SeedWriter& out) {
  const ScratchFolder folder;
  WritePointFiles(out, folder);
  WriteDepthImages(out, folder);
  WriteMeshes(out, folder);
  WriteCaptureSets(out, folder);
  WriteArchives(out, folder);
}

}  // namespace graspdb::fuzz
