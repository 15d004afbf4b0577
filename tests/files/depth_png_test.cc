// Depth images in 16-bit PNG files with the camera beside them.
#include "files/depth/depth_png.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <functional>
#include <vector>

#include "absl/strings/escaping.h"
#include "files/messages/scan_message.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::files {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::IsOk;
using testing::StatusIs;

const DepthPngCamera small_camera = {
    .intrinsics = {.width = 3, .height = 2, .fx = 500.25, .fy = 501, .cx = 1, .cy = 0.5},
    .depth_unit_m = 0.0001};
const std::vector<std::uint16_t> some_counts = {0, 1, 255, 256, 0x1234, 65534};

v1::DepthImage SmallImage() {
  return DepthMessage(some_counts, small_camera.intrinsics, small_camera.depth_unit_m);
}

TEST(DepthPng, RoundTripKeepsEveryCount) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.png";
  ASSERT_THAT(WriteDepthPng(path, SmallImage()), IsOk());
  const auto image = ReadDepthPng(path, small_camera);
  ASSERT_THAT(image, IsOk());
  EXPECT_EQ(*CountsFromMessage(*image), some_counts);
  EXPECT_EQ(DepthUnit(*image), 0.0001);
  EXPECT_EQ(image->intrinsics().fx(), 500.25);
}

TEST(DepthPng, IsBigEndianGreyAsOtherProgramsExpect) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.png";
  ASSERT_THAT(WriteDepthPng(path, SmallImage()), IsOk());
  const std::string bytes = BytesOf(path);
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  EXPECT_EQ(bytes.substr(12, 4), "IHDR");
  EXPECT_EQ(bytes[24], 16);  // bits per channel
  EXPECT_EQ(bytes[25], 0);   // grey
}

TEST(DepthPng, TheSameImageGivesTheSameBytes) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteDepthPng(folder.path() / "a.png", SmallImage()), IsOk());
  ASSERT_THAT(WriteDepthPng(folder.path() / "b.png", SmallImage()), IsOk());
  EXPECT_EQ(BytesOf(folder.path() / "a.png"), BytesOf(folder.path() / "b.png"));
}

TEST(DepthPng, EveryCutShortFileIsRefused) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteDepthPng(folder.path() / "a.png", SmallImage()), IsOk());
  const std::string bytes = BytesOf(folder.path() / "a.png");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto cut = folder.Write("cut.png", bytes.substr(0, size));
    EXPECT_THAT(ReadDepthPng(cut, small_camera),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("cut.png")))
        << size;
  }
}

TEST(DepthPng, AFlippedByteOfTheBodyIsRefused) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteDepthPng(folder.path() / "a.png", SmallImage()), IsOk());
  std::string bytes = BytesOf(folder.path() / "a.png");
  const std::size_t data = bytes.find("IDAT");
  ASSERT_NE(data, std::string::npos);
  bytes[data + 8] = static_cast<char>(bytes[data + 8] ^ 0x55);
  EXPECT_THAT(ReadDepthPng(folder.Write("bad.png", bytes), small_camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("damaged")));
}

TEST(DepthPng, AnotherSizeThanTheCamerasIsRefused) {
  const TemporaryFolder folder;
  ASSERT_THAT(WriteDepthPng(folder.path() / "a.png", SmallImage()), IsOk());
  DepthPngCamera other = small_camera;
  other.intrinsics.width = 4;
  EXPECT_THAT(
      ReadDepthPng(folder.path() / "a.png", other),
      StatusIs(absl::StatusCode::kInvalidArgument, AllOf(HasSubstr("3 x 2"), HasSubstr("4 x 2"))));
}

TEST(DepthPng, OtherFilesAreRejectedAndAMissingFileIsNamed) {
  const TemporaryFolder folder;
  EXPECT_THAT(ReadDepthPng(folder.Write("text.png", "no image at all"), small_camera),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("is not a PNG file")));
  EXPECT_THAT(ReadDepthPng(folder.path() / "none.png", small_camera),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("none.png")));
}

TEST(DepthPng, AnImageWithoutAllItsCountsIsNotWritten) {
  const TemporaryFolder folder;
  v1::DepthImage image = SmallImage();
  image.mutable_data()->pop_back();
  EXPECT_THAT(WriteDepthPng(folder.path() / "a.png", image),
              StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "a.png"));
}

TEST(DepthPng, AnEightBitPictureIsRefusedWithItsKind) {
  const TemporaryFolder folder;
  const std::string picture = absl::HexStringToBytes(
      "89504e470d0a1a0a0000000d4948445200000003000000020800000000b81f39c60000001049"
      "444154789c636064626660616503000046001677f5c87f0000000049454e44ae426082");
  EXPECT_THAT(ReadDepthPng(folder.Write("a.png", picture), small_camera),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("1 channel of 8 bits"), HasSubstr("16-bit grey"))));
}

TEST(DepthPng, SaturatedAndDeclaredCountsAreNoMeasurement) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "a.png";
  const v1::DepthImage image = DepthMessage({0, 65535, 255, 32001, 7, 65534},
                                            small_camera.intrinsics, small_camera.depth_unit_m);
  ASSERT_THAT(WriteDepthPng(path, image), IsOk());
  DepthPngCamera camera = small_camera;
  EXPECT_THAT(*CountsFromMessage(*ReadDepthPng(path, camera)),
              ElementsAre(0, 0, 255, 32001, 7, 65534));
  camera.invalid_counts = {32001, 7};
  EXPECT_THAT(*CountsFromMessage(*ReadDepthPng(path, camera)), ElementsAre(0, 0, 255, 0, 0, 65534));
}

// A slope of one count a column, as a table seen at an angle.
v1::DepthImage Slope(int columns, int rows, const std::function<int(int)>& change) {
  std::vector<std::uint16_t> counts;
  counts.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int i = 0; i < columns * rows; ++i) {
    counts.push_back(static_cast<std::uint16_t>(change(600 + i % columns)));
  }
  return DepthMessage(counts, {columns, rows, 500, 500, 1, 1}, 0.001);
}

TEST(DepthPng, SwappedBytesAreRefused) {
  const TemporaryFolder folder;
  const DepthPngCamera camera = {.intrinsics = {60, 40, 500, 500, 1, 1}};
  const auto path = folder.path() / "a.png";
  ASSERT_THAT(WriteDepthPng(path, Slope(60, 40, [](int count) { return count; })), IsOk());
  EXPECT_THAT(ReadDepthPng(path, camera), IsOk());
  for (const int shift : {0, 8}) {  // swapped, and an 8-bit picture in the high bytes
    const auto change = [&](int count) {
      return (count & 0xFF) << 8 | (count >> 8 << shift) % 256;
    };
    ASSERT_THAT(WriteDepthPng(path, Slope(60, 40, change)), IsOk());
    EXPECT_THAT(ReadDepthPng(path, camera),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("high byte first")));
  }
}

TEST(DepthPng, AnImageOfOneDistanceOrOfNoiseIsNotSwapped) {
  const TemporaryFolder folder;
  const DepthPngCamera camera = {.intrinsics = {60, 40, 500, 500, 1, 1}};
  const auto path = folder.path() / "a.png";
  unsigned state = 1;
  const auto noise = [&](int) { return static_cast<int>((state = state * 1664525 + 1) >> 16U); };
  for (const std::function<int(int)>& change :
       {std::function<int(int)>([](int) { return 1024; }), std::function<int(int)>(noise)}) {
    ASSERT_THAT(WriteDepthPng(path, Slope(60, 40, change)), IsOk());
    EXPECT_THAT(ReadDepthPng(path, camera), IsOk());
  }
}

TEST(Intrinsics, AreReadAsWritten) {
  const TemporaryFolder folder;
  const auto path = folder.path() / kIntrinsicsFile;
  ASSERT_THAT(WriteIntrinsics(path, small_camera), IsOk());
  const auto camera = ReadIntrinsics(path);
  ASSERT_THAT(camera, IsOk());
  EXPECT_EQ(camera->intrinsics.width, 3);
  EXPECT_EQ(camera->intrinsics.fx, 500.25);
  EXPECT_EQ(camera->intrinsics.cy, 0.5);
  EXPECT_EQ(camera->depth_unit_m, 0.0001);
}

TEST(Intrinsics, AreMillimetresWithoutAUnit) {
  const TemporaryFolder folder;
  const auto path = folder.Write(
      "k.json", R"({"width": 4, "height": 3, "fx": 5, "fy": 5, "cx": 2, "cy": 1, "maker": "x"})");
  const auto camera = ReadIntrinsics(path);
  ASSERT_THAT(camera, IsOk());
  EXPECT_EQ(camera->depth_unit_m, 0.001);
}

TEST(Intrinsics, TheUnitMayHaveTheContractsName) {
  const TemporaryFolder folder;
  const auto camera = ReadIntrinsics(folder.Write(
      "k.json",
      R"({"width": 4, "height": 3, "fx": 5, "fy": 5, "cx": 2, "cy": 1, "depth_unit_m": 0.0001})"));
  ASSERT_THAT(camera, IsOk());
  EXPECT_EQ(camera->depth_unit_m, 0.0001);
}

TEST(Intrinsics, MayBeginWithAByteOrderMark) {
  const TemporaryFolder folder;
  const auto camera = ReadIntrinsics(folder.Write(
      "k.json",
      "\xEF\xBB\xBF{\"width\": 4, \"height\": 3, \"fx\": 5, \"fy\": 5, \"cx\": 2, \"cy\": 1}"));
  ASSERT_TRUE(camera.ok()) << camera.status();
  EXPECT_EQ(camera->intrinsics.width, 4);
}

TEST(Intrinsics, ErrorsNameTheInvalidKey) {
  const TemporaryFolder folder;
  const struct {
    const char* text;
    const char* key;
  } cases[] = {
      {R"({"height": 3, "fx": 5, "fy": 5, "cx": 2, "cy": 1})", "width"},
      {R"({"width": 4.5, "height": 3, "fx": 5, "fy": 5, "cx": 2, "cy": 1})", "width"},
      {R"({"width": 4, "height": 3, "fx": 0, "fy": 5, "cx": 2, "cy": 1})", "fx"},
      {R"({"width": 4, "height": 3, "fx": 5, "fy": "5", "cx": 2, "cy": 1})", "fy"},
      {R"({"width": 4, "height": 3, "fx": 5, "fy": 5, "cx": 2, "cy": 1, "depthUnitM": -1})",
       "depthUnitM"},
  };
  for (const auto& c : cases) {
    EXPECT_THAT(ReadIntrinsics(folder.Write("k.json", c.text)),
                StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr(c.key)))
        << c.text;
  }
  EXPECT_THAT(ReadIntrinsics(folder.Write("k.json", "[1, 2")),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("not a JSON")));
  EXPECT_THAT(ReadIntrinsics(folder.path() / "none.json"),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("depthUnitM")));
}

}  // namespace
}  // namespace graspdb::files
