// The format of archives: what is written is read, and nothing else is.
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <functional>

#include "absl/strings/str_cat.h"
#include "files/archives/archive_file.h"
#include "files/archives/archive_index.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::files {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::size_t kHeaderBytes = 4;  // of the file

v1::ArchiveRecord HeaderRecord() {
  v1::ArchiveRecord out;
  out.mutable_header()->set_catalog_revision(7);
  return out;
}

v1::ArchiveRecord ObjectRecord(const std::string& id) {
  v1::ArchiveRecord out;
  out.mutable_object()->set_name("objects/" + id);
  out.mutable_object()->set_display_name("A part");
  return out;
}

v1::ArchiveRecord PoseRecord(const std::string& object) {
  v1::ArchiveRecord out;
  out.mutable_stable_pose()->set_name("objects/" + object + "/stablePoses/flat");
  out.mutable_stable_pose()->set_symmetry_order(2);
  return out;
}

v1::ArchiveRecord ViewRecord(const std::string& object, const std::string& id,
                             std::size_t points = 20) {
  v1::ArchiveRecord out;
  v1::View& view = *out.mutable_view();
  view.set_name("objects/" + object + "/stablePoses/flat/views/" + id);
  *view.mutable_object_pose() = ToMessage(recognition::Pose::Identity());
  *view.mutable_sensor_pose() = ToMessage(recognition::Pose::Identity());
  recognition::Points cloud(points, Eigen::Vector3f(0.1F, 0.2F, 0.5F));
  *view.mutable_cloud() = CloudMessage(cloud, 0);
  return out;
}

v1::ArchiveRecord EndRecord(int objects, int poses, int views) {
  v1::ArchiveRecord out;
  out.mutable_end()->set_object_count(objects);
  out.mutable_end()->set_stable_pose_count(poses);
  out.mutable_end()->set_view_count(views);
  return out;
}

class ArchiveFileTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::vector<v1::ArchiveRecord>& records) {
    std::filesystem::path path = folder_.path() / "file.graspdb";
    std::filesystem::remove(path);
    auto writer = ArchiveWriter::Create(path);
    EXPECT_THAT(writer, IsOk());
    for (const v1::ArchiveRecord& record : records) EXPECT_THAT(writer->Add(record), IsOk());
    EXPECT_FALSE(std::filesystem::exists(path)) << "seen before it is complete";
    EXPECT_THAT(writer->Finish(), IsOk());
    return path;
  }

  static absl::StatusOr<ArchiveIndex> Index(const std::filesystem::path& path) {
    const auto file = ArchiveFile::Open(path);
    if (!file.ok()) return file.status();
    return IndexArchive(**file, nullptr);
  }

  // Writes and reads an archive of `views` views of 1.2 MB each, one at a time.
  static void WriteAndIndex(const std::filesystem::path& path, int views) {
    auto writer = ArchiveWriter::Create(path);
    ASSERT_THAT(writer, IsOk());
    for (const v1::ArchiveRecord& record : {HeaderRecord(), ObjectRecord("a"), PoseRecord("a")}) {
      ASSERT_THAT(writer->Add(record), IsOk());
    }
    for (int i = 0; i < views; ++i) {
      ASSERT_THAT(writer->Add(ViewRecord("a", absl::StrCat(1000 + i), 100'000)), IsOk());
    }
    ASSERT_THAT(writer->Add(EndRecord(1, 1, views)), IsOk());
    ASSERT_THAT(writer->Finish(), IsOk());
    ASSERT_THAT(Index(path), IsOk());
  }

  absl::StatusOr<ArchiveIndex> IndexOf(const std::string& bytes) {
    return Index(folder_.Write("bytes.graspdb", bytes));
  }

  const std::vector<v1::ArchiveRecord> sample_ = {
      HeaderRecord(),         ObjectRecord("mug"), PoseRecord("mug"), ViewRecord("mug", "a"),
      ViewRecord("mug", "b"), ObjectRecord("nut"), EndRecord(2, 1, 2)};
  const TemporaryFolder folder_;
};

TEST_F(ArchiveFileTest, HasWhatWasWritten) {
  const auto file = ArchiveFile::Open(Write(sample_));
  ASSERT_THAT(file, IsOk());
  const auto index = IndexArchive(**file, nullptr);
  ASSERT_THAT(index, IsOk());
  EXPECT_FALSE(index->has_unknown_fields);
  ASSERT_EQ(index->entries.size(), 5U);
  for (std::size_t i = 0; i < index->entries.size(); ++i) {
    const auto item = (*file)->ReadAt(index->entries[i].offset);
    ASSERT_THAT(item, IsOk());
    EXPECT_EQ(item->record.SerializeAsString(), sample_[i + 1].SerializeAsString());
  }
  EXPECT_EQ(index->entries[3].name, "objects/mug/stablePoses/flat/views/b");
  EXPECT_EQ(index->entries[4].kind, ArchiveKind::kObject);
}

TEST_F(ArchiveFileTest, TheSameRecordsGiveTheSameBytes) {
  const std::string first = BytesOf(Write(sample_));
  EXPECT_EQ(BytesOf(Write(sample_)), first);
}

TEST_F(ArchiveFileTest, AWriterWithoutEndLeavesNothing) {
  {
    auto writer = ArchiveWriter::Create(folder_.path() / "file.graspdb");
    ASSERT_THAT(writer, IsOk());
    ASSERT_THAT(writer->Add(HeaderRecord()), IsOk());
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(ArchiveFileTest, EveryTruncatedFileIsAnError) {
  const std::string bytes = BytesOf(Write(sample_));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto index = IndexOf(bytes.substr(0, size));
    if (size < kHeaderBytes) {
      EXPECT_THAT(index, StatusIs(absl::StatusCode::kInvalidArgument)) << size;
    } else {
      EXPECT_THAT(index, StatusIs(absl::StatusCode::kDataLoss,
                                  AllOf(HasSubstr("bytes.graspdb"), HasSubstr("at byte "),
                                        HasSubstr("copy the file again"))))
          << size;
    }
  }
}

TEST_F(ArchiveFileTest, EveryDamagedByteIsAnError) {
  const std::string bytes = BytesOf(Write(sample_));
  for (std::size_t at = kHeaderBytes; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    EXPECT_THAT(IndexOf(damaged), StatusIs(absl::StatusCode::kDataLoss)) << at;
  }
}

TEST_F(ArchiveFileTest, ForeignFilesAndOtherFormatsAreErrors) {
  EXPECT_THAT(IndexOf("{ \"objects\": [] }"),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("is not an archive")));
  EXPECT_THAT(Index(folder_.path()), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(Index(folder_.path() / "missing"),
              StatusIs(absl::StatusCode::kNotFound, HasSubstr("check the path")));
  std::string newer = BytesOf(Write(sample_));
  newer[kHeaderBytes - 1] = 2;
  EXPECT_THAT(IndexOf(newer),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("has format 2")));
}

// A record whose header declares `bytes`, with the right checksum.
std::string Framed(std::uint32_t bytes, const std::string& frame) {
  const std::string length = storage::ToLittleEndian(bytes);
  return length + storage::ToLittleEndian(storage::Crc32c(frame, storage::Crc32c(length))) + frame;
}

TEST_F(ArchiveFileTest, HostileSizesAreErrors) {
  const std::string magic = BytesOf(Write(sample_)).substr(0, kHeaderBytes);
  EXPECT_THAT(IndexOf(magic + Framed(0xffffffff, "x")), StatusIs(absl::StatusCode::kDataLoss));
  EXPECT_THAT(IndexOf(magic + Framed(0, "")), StatusIs(absl::StatusCode::kDataLoss));
  // zstd's magic and a header that declares 2^62 bytes.
  const std::string bomb = std::string("\x28\xb5\x2f\xfd\xe0", 5) + std::string(7, '\0') + "\x40";
  EXPECT_THAT(IndexOf(magic + Framed(static_cast<std::uint32_t>(bomb.size()), bomb)),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("cannot be unpacked")));
}

// Small fields take many times their bytes in memory.
TEST_F(ArchiveFileTest, OnlyPointsMayBeLarge) {
  v1::ArchiveRecord object = ObjectRecord("a");
  object.mutable_object()->set_display_name(std::string(2U << 20, 'x'));
  EXPECT_THAT(Index(Write({HeaderRecord(), object, EndRecord(1, 0, 0)})),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("a record is too large")));
  EXPECT_THAT(Index(Write({HeaderRecord(), ObjectRecord("a"), PoseRecord("a"),
                           ViewRecord("a", "1", 100'000), EndRecord(1, 1, 1)})),
              IsOk());
}

struct WrongOrder {
  std::string name;
  std::vector<v1::ArchiveRecord> records;
};

class WrongOrderTest : public ArchiveFileTest, public ::testing::WithParamInterface<WrongOrder> {};

TEST_P(WrongOrderTest, IsAnError) {
  EXPECT_THAT(Index(Write(GetParam().records)), StatusIs(absl::StatusCode::kDataLoss));
}

v1::ArchiveRecord With(v1::ArchiveRecord record,
                       const std::function<void(v1::ArchiveRecord&)>& change) {
  change(record);
  return record;
}

INSTANTIATE_TEST_SUITE_P(
    Archives, WrongOrderTest,
    ::testing::Values(
        WrongOrder{"NoHeader", {ObjectRecord("a"), EndRecord(1, 0, 0)}},
        WrongOrder{"TwoHeaders", {HeaderRecord(), HeaderRecord(), EndRecord(0, 0, 0)}},
        WrongOrder{"NoEnd", {HeaderRecord(), ObjectRecord("a")}},
        WrongOrder{"AfterTheEnd", {HeaderRecord(), EndRecord(0, 0, 0), ObjectRecord("a")}},
        WrongOrder{"MissingRecords", {HeaderRecord(), ObjectRecord("a"), EndRecord(2, 0, 0)}},
        WrongOrder{"Twice",
                   {HeaderRecord(), ObjectRecord("a"), ObjectRecord("a"), EndRecord(2, 0, 0)}},
        WrongOrder{"NotAscending",
                   {HeaderRecord(), ObjectRecord("b"), ObjectRecord("a"), EndRecord(2, 0, 0)}},
        WrongOrder{"PoseOfAnother",
                   {HeaderRecord(), ObjectRecord("a"), PoseRecord("b"), EndRecord(1, 1, 0)}},
        WrongOrder{"ViewWithoutPose",
                   {HeaderRecord(), ObjectRecord("a"), ViewRecord("a", "1"), EndRecord(1, 0, 1)}},
        WrongOrder{"Escape", {HeaderRecord(), ObjectRecord("a\x1b[2J"), EndRecord(1, 0, 0)}},
        WrongOrder{"LongName",
                   {HeaderRecord(), ObjectRecord(std::string(64, 'a')), EndRecord(1, 0, 0)}},
        WrongOrder{"Empty", {HeaderRecord(), v1::ArchiveRecord(), EndRecord(0, 0, 0)}},
        WrongOrder{"NoCloud",
                   {HeaderRecord(), ObjectRecord("a"), PoseRecord("a"),
                    With(ViewRecord("a", "1"), [](auto& r) { r.mutable_view()->clear_cloud(); }),
                    EndRecord(1, 1, 1)}},
        WrongOrder{
            "NoSensorPose",
            {HeaderRecord(), ObjectRecord("a"), PoseRecord("a"),
             With(ViewRecord("a", "1"), [](auto& r) { r.mutable_view()->clear_sensor_pose(); }),
             EndRecord(1, 1, 1)}},
        WrongOrder{"OddCloud",
                   {HeaderRecord(), ObjectRecord("a"), PoseRecord("a"),
                    With(ViewRecord("a", "1"),
                         [](auto& r) {
                           r.mutable_view()->mutable_cloud()->mutable_data()->push_back('x');
                         }),
                    EndRecord(1, 1, 1)}}),
    [](const auto& order) { return order.param.name; });

TEST_F(ArchiveFileTest, FieldsOfANewerProgramAreLeftOut) {
  v1::ArchiveRecord object = ObjectRecord("mug");
  object.mutable_object()
      ->GetReflection()
      ->MutableUnknownFields(object.mutable_object())
      ->AddVarint(1234, 1);
  const auto file = ArchiveFile::Open(Write({HeaderRecord(), object, EndRecord(1, 0, 0)}));
  ASSERT_THAT(file, IsOk());
  const auto index = IndexArchive(**file, nullptr);
  ASSERT_THAT(index, IsOk());
  EXPECT_TRUE(index->has_unknown_fields);
  const auto item = (*file)->ReadAt(index->entries[0].offset);
  ASSERT_THAT(item, IsOk());
  EXPECT_EQ(item->record.SerializeAsString(), ObjectRecord("mug").SerializeAsString());
}

std::int64_t MaxResidentKib() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return use.ru_maxrss;
}

// The first archive is larger than the 256 MB of freed memory that the address sanitizer keeps.
TEST_F(ArchiveFileTest, MemoryDoesNotGrowWithTheNumberOfViews) {
  WriteAndIndex(folder_.path() / "large.graspdb", 300);
  const std::int64_t before = MaxResidentKib();
  WriteAndIndex(folder_.path() / "twice_as_large.graspdb", 600);
  EXPECT_LT(MaxResidentKib() - before, 64 * 1024);
}

}  // namespace
}  // namespace graspdb::files
