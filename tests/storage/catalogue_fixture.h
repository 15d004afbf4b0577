// Common code of the catalogue's tests: a temporary directory, records to store, and a
// picture of all contents of a catalogue.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::storage {

// A directory of its own, removed with the object.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // The path of `name` in it.
  std::string operator/(std::string_view name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

v1::Object MakeObject(std::string_view object_id, std::string_view display_name = "");
v1::StablePose MakeStablePose(std::string_view object_id, std::string_view stable_pose_id);
v1::Cell MakeCell(std::string_view cell_id);
// A view with a cloud of `cloud_bytes` bytes; content and digest follow from `seed`.
NewView MakeView(std::string_view name, int seed = 1, std::size_t cloud_bytes = 500);

// Opens or fails the test.
std::unique_ptr<Catalogue> OpenOrDie(const std::string& directory, CatalogueOptions options = {});

// Every record, cloud and change record of a catalogue by name; equal pictures, equal content.
struct Picture {
  std::int64_t revision = 0;
  std::map<std::string, std::string> records;
  std::map<std::string, std::string> clouds;
  std::map<std::int64_t, std::string> changes;

  bool operator==(const Picture&) const = default;
};

// Reads everything. Fails the test (and returns an error) when it cannot be read; also
// when counts, clouds or the replayed change records do not match the records.
absl::StatusOr<Picture> TakePicture(const Catalogue& catalogue);

// Twelve different changes to a new catalogue: creates, updates, views, deletes. `after`
// is called after each one.
void MakeHistory(Catalogue& catalogue, const std::function<void()>& after);

std::string ReadBytes(const std::filesystem::path& path);
void WriteBytes(const std::filesystem::path& path, std::string_view bytes);
// Copies a database directory as a crash would leave it.
void CopyDatabase(const std::string& from, const std::string& to);

}  // namespace graspdb::storage
