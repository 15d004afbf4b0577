// Every kind of malformed PCD file is reported in one sentence with the path.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "files/points/point_file.h"
#include "tests/files/temporary_folder.h"

namespace graspdb::files {
namespace {

using ::testing::HasSubstr;

using Lines = std::map<std::string, std::string>;

// A header of three points with some lines replaced or, when empty, left out.
std::string Header(const Lines& other = {}) {
  std::string text = "# .PCD v0.7 - Point Cloud Data file format\n";
  Lines lines = {{"VERSION", "0.7"}, {"FIELDS", "x y z"}, {"SIZE", "4 4 4"},
                 {"TYPE", "F F F"},  {"COUNT", "1 1 1"},  {"WIDTH", "3"},
                 {"HEIGHT", "1"},    {"POINTS", "3"},     {"VIEWPOINT", "0 0 0 1 0 0 0"},
                 {"DATA", "ascii"}};
  for (const auto& [key, value] : other) lines[key] = value;
  for (const char* key : {"VERSION", "FIELDS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT",
                          "VIEWPOINT", "POINTS", "DATA"}) {
    if (!lines[key].empty()) text += std::string(key) + " " + lines[key] + "\n";
  }
  return text;
}

constexpr char kRows[] = "1 2 3\n4 5 6\n7 8 9\n";

void ExpectRefused(const std::string& bytes, const std::string& what) {
  const TemporaryFolder folder;
  const auto path = folder.Write("cloud.pcd", bytes);
  const auto read = ReadPointFile(path);
  ASSERT_FALSE(read.ok()) << what;
  EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument);
  const std::string message(read.status().message());
  EXPECT_THAT(message, ::testing::StartsWith(path.string()));
  EXPECT_THAT(message, HasSubstr(what));
  EXPECT_THAT(message, HasSubstr("; ")) << "no advice";
  EXPECT_THAT(message, ::testing::Not(HasSubstr("\n")));
}

TEST(PcdMalformed, TheUnchangedFileIsRead) {
  const TemporaryFolder folder;
  const auto read = ReadPointFile(folder.Write("cloud.pcd", Header() + kRows));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points[2], Eigen::Vector3f(7, 8, 9));
}

TEST(PcdMalformed, HeaderLines) {
  ExpectRefused("Dear diary,\ntoday I found a cloud.\n", "not a PCD file");
  ExpectRefused(std::string("\x7f"
                            "ELF\0\1\2",
                            7),
                "no DATA line");
  ExpectRefused(std::string(300000, 'a'), "no DATA line");
  ExpectRefused(Header({{"DATA", ""}}), "no DATA line");
  ExpectRefused(Header({{"DATA", "zip"}}) + kRows, "DATA line");
  ExpectRefused(Header({{"FIELDS", ""}}) + kRows, "SIZE line has 3 entries for 0 fields");
  ExpectRefused(Header({{"FIELDS", "x y intensity"}}) + kRows, "0 fields named z");
  ExpectRefused(Header({{"FIELDS", "x y x"}}) + kRows, "2 fields named x");
  ExpectRefused(Header({{"SIZE", "4 4"}}) + kRows, "SIZE line has 2 entries for 3 fields");
  ExpectRefused(Header({{"SIZE", "4 4 5"}}) + kRows, "\"5\" where 1, 2, 4 or 8");
  ExpectRefused(Header({{"SIZE", ""}}) + kRows, "no SIZE line");
  ExpectRefused(Header({{"TYPE", "F F I"}}) + kRows, "field z is not one float or double");
  ExpectRefused(Header({{"TYPE", "F F G"}}) + kRows, "\"G\" where F, I or U");
  ExpectRefused(Header({{"COUNT", "1 1 -1"}}) + kRows, "COUNT line has \"-1\"");
  ExpectRefused(Header({{"COUNT", "1 1 2"}}) + kRows, "field z is not one float or double");
  ExpectRefused(Header({{"HEIGHT", ""}}) + kRows, "no HEIGHT line");
  ExpectRefused(Header({{"WIDTH", "three"}}) + kRows, "WIDTH line does not give one whole number");
  ExpectRefused(Header({{"POINTS", "4"}}) + kRows, "POINTS 4, but WIDTH 3 and HEIGHT 1");
  ExpectRefused(Header({{"POINTS", "0"}, {"WIDTH", "0"}}), "promises no points");
}

TEST(PcdMalformed, AbsurdCounts) {
  ExpectRefused(Header({{"WIDTH", "20000000"}, {"POINTS", "20000000"}, {"DATA", "binary"}}),
                "promises 20000000 points");
  ExpectRefused(Header({{"WIDTH", "9000000"}, {"HEIGHT", "9000000"}, {"POINTS", "9000000"}}),
                "POINTS 9000000, but WIDTH 9000000 and HEIGHT 9000000");
  ExpectRefused(Header({{"WIDTH", "99999999999999999999"}}), "WIDTH line");
  ExpectRefused(Header({{"WIDTH", "-3"}, {"POINTS", "-3"}}), "WIDTH line");
  ExpectRefused(Header({{"FIELDS", "x y z histogram"},
                        {"SIZE", "4 4 4 8"},
                        {"TYPE", "F F F F"},
                        {"COUNT", "1 1 1 1024"},
                        {"WIDTH", "10000000"},
                        {"POINTS", "10000000"}}),
                "more than 4 GiB");
}

TEST(PcdMalformed, AsciiRows) {
  ExpectRefused(Header() + "1 2 3\n4 5 6\n", "has 2 points, and its header promises 3");
  ExpectRefused(Header(), "has 0 points");
  ExpectRefused(Header() + kRows + "1 1 1\n", "has 4 points");
  ExpectRefused(Header() + "1 2 3\n4 5\n7 8 9\n", "row 2 of its points has 2 numbers instead of 3");
  ExpectRefused(Header() + "1 2 3\n4 5 6 7\n7 8 9\n", "row 2 of its points has 4 numbers");
  ExpectRefused(Header() + "1 2 3\n4 five 6\n7 8 9\n", "row 2 of its points has \"five\"");
  ExpectRefused(Header() + "1 2 3\n4 5,5 6\n7 8 9\n", "\"5,5\"");
  ExpectRefused(Header() + "1 2 3\n4 inf 6\n7 8 9\n", "\"inf\" where a finite number or nan");
  ExpectRefused(Header() + "1 2 3\n4 1e39 6\n7 8 9\n", "\"1e39\"");
}

TEST(PcdMalformed, BinaryBodies) {
  const Lines binary = {{"DATA", "binary"}};
  ExpectRefused(Header(binary), "has 0 bytes of points, and its header promises 36");
  ExpectRefused(Header(binary) + std::string(35, 'x'), "has 35 bytes");
}

// Earlier versions of PCL write one page of memory more than the points, and some bytes less for
// the header.
TEST(PcdMalformed, BytesBehindTheBodyAreErrorsIfNotZeros) {
  std::vector<std::string> files = {Header({{"DATA", "binary"}}) + std::string(36, '\x3e')};
  {
    const TemporaryFolder folder;
    const PointFile points{.points = recognition::Points(9, {1, 2, 3}),
                           .normals = {},
                           .width = 9,
                           .height = 1,
                           .sensor_pose = {}};
    ASSERT_TRUE(WritePcd(folder.path() / "a.pcd", points).ok());
    files.push_back(BytesOf(folder.path() / "a.pcd"));
  }
  for (const std::string& whole : files) {
    ExpectRefused(whole + "\n", "and 1 more bytes follow");
    ExpectRefused(whole + std::string(36, '\x3e'), "and 36 more bytes follow");
    ExpectRefused(whole + std::string(65536, '\0'), "and 65536 more bytes follow");
    const TemporaryFolder folder;
    const auto read = ReadPointFile(folder.Write("b.pcd", whole + std::string(3900, '\0')));
    EXPECT_TRUE(read.ok()) << read.status();
  }
}

// The first four bytes of the body are the letters DATA.
TEST(PcdMalformed, ABodyMayLookLikeAHeaderLine) {
  const TemporaryFolder folder;
  const std::string body = "DATA binary\nPOINTS 9\n" + std::string(15, '\x3e');
  const auto read = ReadPointFile(folder.Write("a.pcd", Header({{"DATA", "binary"}}) + body));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points.front().x(), 13.265934F);
}

// As cameras and laser scanners with a structure in memory write it; PCL rejects the count 0.
TEST(PcdMalformed, PaddingFieldsAreSkipped) {
  const TemporaryFolder folder;
  const std::string header = Header({{"FIELDS", "x y z _ ring _"},
                                     {"SIZE", "4 4 4 1 2 1"},
                                     {"TYPE", "F F F U U U"},
                                     {"COUNT", "1 1 1 4 1 0"},
                                     {"WIDTH", "1"},
                                     {"POINTS", "1"},
                                     {"DATA", "binary"}});
  const auto read = ReadPointFile(folder.Write("a.pcd", header + std::string(18, '\x3e')));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points.size(), 1U);
  ExpectRefused(Header({{"COUNT", "1 1 0"}}) + kRows, "COUNT line has \"0\"");
}

TEST(PcdMalformed, AByteOrderMarkIsSkipped) {
  const TemporaryFolder folder;
  const std::string mark = "\xEF\xBB\xBF";
  const std::string binary = Header({{"DATA", "binary"}}) + std::string(36, '\x3e');
  EXPECT_TRUE(ReadPointFile(folder.Write("a.pcd", mark + Header() + kRows)).ok());
  EXPECT_TRUE(ReadPointFile(folder.Write("b.pcd", mark + binary)).ok());
  ExpectRefused(std::string("V\0E\0R\0\n\0", 8), "has the encoding UTF-16");
}

TEST(PcdMalformed, ACopyInTextModeIsNamed) {
  // Two bytes 0A became 0D 0A. The last two bytes are zeros, but no padding.
  const std::string body = "abc\r\ndef\r\n" + std::string(26, 'x') + std::string(2, '\0');
  ExpectRefused(Header({{"DATA", "binary"}}) + body, "looks like a copy in text mode");
}

std::string Compressed(std::uint32_t packed, std::uint32_t unpacked, const std::string& body) {
  std::string bytes = Header({{"DATA", "binary_compressed"}});
  bytes.append(reinterpret_cast<const char*>(&packed), sizeof(packed));
  bytes.append(reinterpret_cast<const char*>(&unpacked), sizeof(unpacked));
  return bytes + body;
}

TEST(PcdMalformed, CompressedBodies) {
  ExpectRefused(Header({{"DATA", "binary_compressed"}}) + "1234567", "ends before its sizes");
  ExpectRefused(Compressed(10, 37, std::string(10, 'x')), "unpacks to 37 bytes");
  ExpectRefused(Compressed(10, 0xffffffffU, std::string(10, 'x')), "unpacks to 4294967295 bytes");
  ExpectRefused(Compressed(11, 36, std::string(10, 'x')),
                "declares 11 compressed bytes, and has 10");
  ExpectRefused(Compressed(0, 36, std::string(10, 'x')), "declares 0 compressed bytes");
  ExpectRefused(Compressed(10, 36, std::string(10, 'x')), "cannot be unpacked");
  ExpectRefused(Compressed(10, 36, std::string(10, '\xff')), "cannot be unpacked");
  const std::string padded = Header({{"FIELDS", "x y z _"},
                                     {"SIZE", "4 4 4 1"},
                                     {"TYPE", "F F F U"},
                                     {"COUNT", "1 1 1 4"},
                                     {"DATA", "binary_compressed"}});
  ExpectRefused(padded + std::string(60, 'x'), "padding fields");
}

// A few bytes cannot unpack to a million points, so no memory is taken for them.
TEST(PcdMalformed, CompressedBodiesThatDeclareMoreThanTheyCanUnpackTo) {
  const Lines lines = {{"DATA", "binary_compressed"}, {"WIDTH", "1000000"}, {"POINTS", "1000000"}};
  const std::string sizes("\x0a\0\0\0\x00\x1b\xb7\x00", 8);  // 10, 12 million
  ExpectRefused(Header(lines) + sizes + std::string(10, 'x'), "10 compressed bytes cannot hold");
}

// As editors on other systems leave them. PCL's reader ends its header there, and then crashes.
TEST(PcdMalformed, BlankLinesInTheHeaderAreIgnored) {
  const TemporaryFolder folder;
  const std::string bytes = "\n\r\n \n" + Header({{"DATA", "binary"}}) + std::string(36, '\x3e');
  const auto read = ReadPointFile(folder.Write("cloud.pcd", bytes));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points.size(), 3U);
}

TEST(PcdMalformed, Viewpoints) {
  ExpectRefused(Header({{"VIEWPOINT", "0 0 1 0 0 0 0"}}) + kRows, "norm 0 instead of 1");
  ExpectRefused(Header({{"VIEWPOINT", "0 0 1 1 1 0 0"}}) + kRows, "instead of 1");
  ExpectRefused(Header({{"VIEWPOINT", "0 0 1"}}) + kRows, "does not give seven numbers");
  ExpectRefused(Header({{"VIEWPOINT", "0 0 nan 1 0 0 0"}}) + kRows, "does not give seven numbers");
  // It could not be written again, in single precision.
  ExpectRefused(Header({{"VIEWPOINT", "0 0 -1e39 1 0 0 0"}}) + kRows,
                "does not give seven numbers");
}

// Whatever bytes are changed: a value or an error, never a crash or a short cloud.
TEST(PcdMalformed, FlippedBytesNeverCrash) {
  const TemporaryFolder folder;
  PointFile file{.points = recognition::Points(40, Eigen::Vector3f(1, 2, 3)),
                 .normals = {},
                 .width = 8,
                 .height = 5,
                 .sensor_pose = {}};
  for (std::size_t i = 0; i < file.points.size(); i += 3) {
    file.points[i].x() = static_cast<float>(i);
  }
  ASSERT_TRUE(WritePcd(folder.path() / "good.pcd", file).ok());
  const std::string good = BytesOf(folder.path() / "good.pcd");
  std::mt19937 random(7);  // NOLINT: the same bytes every time
  for (int round = 0; round < 2000; ++round) {
    std::string bytes = good;
    for (int k = 0; k <= round % 3; ++k)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    if (round % 5 == 0) bytes.resize(random() % bytes.size());
    const auto read = ReadPointFile(folder.Write("bad.pcd", bytes));
    if (!read.ok()) continue;
    const auto count =
        static_cast<std::size_t>(read->width) * static_cast<std::size_t>(read->height);
    EXPECT_EQ(read->points.size(), count);
  }
}

}  // namespace
}  // namespace graspdb::files
