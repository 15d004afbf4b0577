// Changes a closed database without the catalogue; for tests only.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace graspdb::storage {

// Creates an empty RocksDB database.
void MakeEmptyDatabase(const std::string& directory);
// Creates a RocksDB database that is not a catalogue, with one key.
void MakeForeignDatabase(const std::string& directory);
// Sets the schema version of the catalogue in `directory`.
void SetSchemaVersion(const std::string& directory, int version);
// Writes (or, without a value, removes) one key of a family.
void Tamper(const std::string& directory, std::string_view family, std::string_view key,
            const std::string* value);
// Adds a column family that is unknown to this program.
void AddFamily(const std::string& directory, const std::string& name);
// Removes a column family with its contents.
void DropFamily(const std::string& directory, const std::string& name);
// Moves everything from the log to sorted files.
void FlushToFiles(const std::string& directory);

// Number of blobs (clouds) that this thread has read from files so far.
std::uint64_t BlobsReadHere();

}  // namespace graspdb::storage
