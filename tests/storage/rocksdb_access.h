// Changes a closed database behind the catalogue's back, as only tests may.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace graspdb::storage {

// Makes a RocksDB database in which nothing was ever written.
void MakeEmptyDatabase(const std::string& directory);
// Makes a RocksDB database that no catalogue made, with one key in it.
void MakeForeignDatabase(const std::string& directory);
// Sets the schema version of the catalogue in `directory`.
void SetSchemaVersion(const std::string& directory, int version);
// Writes (or, without a value, removes) one key of a family.
void Tamper(const std::string& directory, std::string_view family, std::string_view key,
            const std::string* value);
// Adds a column family that this program does not know.
void AddFamily(const std::string& directory, const std::string& name);
// Removes a column family with all that is in it.
void DropFamily(const std::string& directory, const std::string& name);
// Moves everything from the log to sorted files.
void FlushToFiles(const std::string& directory);

// Blobs, that is clouds, that this thread has read from files so far.
std::uint64_t BlobsReadHere();

}  // namespace graspdb::storage
