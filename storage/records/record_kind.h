// Traits of the kinds of records: family, name, parent, word. Internal to storage/.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/status_macros.h"
#include "graspdb/v1/catalog.pb.h"
#include "graspdb/v1/cell.pb.h"
#include "storage/database/database.h"
#include "storage/database/family.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// The kind of a record that another one belongs to.
struct Parent {
  Family family = Family::kMeta;  // kMeta: no parent
  std::string name;
};

template <typename Record>
struct Kind;

template <>
struct Kind<v1::Object> {
  static constexpr Family kFamily = Family::kObjects;
  static constexpr std::string_view kWord = "object";
  static constexpr std::string_view kCollection = "objects/";
  static absl::StatusOr<Parent> ParentOf(std::string_view name);
};

template <>
struct Kind<v1::StablePose> {
  static constexpr Family kFamily = Family::kStablePoses;
  static constexpr std::string_view kWord = "stable pose";
  static constexpr std::string_view kCollection = "/stablePoses/";
  static absl::StatusOr<Parent> ParentOf(std::string_view name);
};

template <>
struct Kind<ViewRecord> {
  static constexpr Family kFamily = Family::kViews;
  static constexpr std::string_view kWord = "view";
  static constexpr std::string_view kCollection = "/views/";
  static absl::StatusOr<Parent> ParentOf(std::string_view name);
};

template <>
struct Kind<v1::Cell> {
  static constexpr Family kFamily = Family::kCells;
  static constexpr std::string_view kWord = "cell";
  static constexpr std::string_view kCollection = "cells/";
  static absl::StatusOr<Parent> ParentOf(std::string_view name);
};

template <>
struct Kind<GraspOutcomesRecord> {
  static constexpr Family kFamily = Family::kGraspOutcomes;
  static constexpr std::string_view kWord = "outcomes of the stable pose";
  static absl::StatusOr<Parent> ParentOf(std::string_view name);
};

template <>
struct Kind<UploadRecord> {
  static constexpr Family kFamily = Family::kUploads;
  static constexpr std::string_view kWord = "upload";
  static constexpr std::string_view kCollection = "uploads/";
  static absl::StatusOr<Parent> ParentOf(std::string_view name);
};

template <>
struct Kind<DeletedObjectRecord> {
  static constexpr Family kFamily = Family::kDeletedObjects;
  static constexpr std::string_view kWord = "deleted object";
  static constexpr std::string_view kCollection = "objects/";
  static absl::StatusOr<Parent> ParentOf(std::string_view name);
};

// What to do where there is no record of that name.
template <typename Record>
inline constexpr std::string_view kMissingAdvice = "list the existing ones, or create it first";
template <>
inline constexpr std::string_view kMissingAdvice<UploadRecord> = "list the existing ones";
template <>
inline constexpr std::string_view kMissingAdvice<DeletedObjectRecord> =
    "graspdb objects list --deleted lists those that are kept, graspdb objects history what became "
    "of an object";

absl::Status NotFound(std::string_view word, std::string_view name, std::string_view advice);
template <typename Record>
absl::Status NotFound(std::string_view name) {
  return NotFound(Kind<Record>::kWord, name, kMissingAdvice<Record>);
}
absl::Status AlreadyExists(std::string_view word, std::string_view name);
absl::Status DamagedRecord(std::string_view name);

// NOT_FOUND if there is a `parent` and it does not exist.
absl::Status CheckParent(const Database& database, const Parent& parent);

// Parses the record in `bytes`, the value of the key `name`; DATA_LOSS if it is invalid.
template <typename Record>
absl::StatusOr<Record> ParseRecord(std::string_view name, std::string_view bytes) {
  Record record;
  if (!record.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) ||
      record.name() != name) {
    return DamagedRecord(name);
  }
  return record;
}

// The record of that name. INVALID_ARGUMENT for an invalid name, NOT_FOUND without a record.
template <typename Record>
absl::StatusOr<Record> ReadRecord(const Database& database, std::string_view name) {
  RETURN_IF_ERROR(Kind<Record>::ParentOf(name).status());
  const auto bytes = database.Get(Kind<Record>::kFamily, name);
  if (absl::IsNotFound(bytes.status())) return NotFound<Record>(name);
  if (!bytes.ok()) return bytes.status();
  return ParseRecord<Record>(name, *bytes);
}

// The key of the cloud of a view in the family `clouds`.
inline const std::string& CloudKeyOf(const ViewRecord& view) {
  return view.cloud_key().empty() ? view.name() : view.cloud_key();
}

}  // namespace graspdb::storage
