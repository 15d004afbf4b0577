#include "tests/fuzz/message_mutator.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace graspdb::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

// A step from one input to the next; with more fields at once most inputs are invalid in several
// places, and the first failed check hides the others.
constexpr std::size_t kMaxChanges = 4;
// Lists grow one by one: copies of copies double quickly.
constexpr int kLongestList = 64;

}  // namespace

void MessageMutator::Collect(Message& message, std::vector<Slot>& out) {
  const Reflection* reflection = message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message.GetDescriptor()->field(i);
    out.push_back({&message, field});
    const bool is_set = field->is_repeated() ? reflection->FieldSize(message, field) > 0
                                             : reflection->HasField(message, field);
    if (!is_set) continue;
    out.push_back({&message, field});  // twice, since fields that are set matter more
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    if (!field->is_repeated()) {
      Collect(*reflection->MutableMessage(&message, field), out);
      continue;
    }
    for (int k = 0; k < reflection->FieldSize(message, field); ++k) {
      Collect(*reflection->MutableRepeatedMessage(&message, field, k), out);
    }
  }
}

void MessageMutator::CollectMessages(Message& message, std::vector<Message*>& out) {
  out.push_back(&message);
  const Reflection* reflection = message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    if (!field->is_repeated()) {
      CollectMessages(*reflection->MutableMessage(&message, field), out);
      continue;
    }
    for (int k = 0; k < reflection->FieldSize(message, field); ++k) {
      CollectMessages(*reflection->MutableRepeatedMessage(&message, field, k), out);
    }
  }
}

void MessageMutator::Mutate(Message& message) {
  const std::size_t changes = 1 + Pick(kMaxChanges);
  for (std::size_t i = 0; i < changes; ++i) {
    std::vector<Slot> slots;
    Collect(message, slots);
    if (!slots.empty()) MutateSlot(slots[Pick(slots.size())]);
  }
}

void MessageMutator::Cross(const Message& from, Message& into) {
  std::vector<Message*> places;
  CollectMessages(into, places);
  const std::unique_ptr<Message> source(from.New());
  source->CopyFrom(from);
  std::vector<Message*> parts;
  CollectMessages(*source, parts);
  Message& place = *places[Pick(places.size())];
  std::erase_if(
      parts, [&](const Message* part) { return part->GetDescriptor() != place.GetDescriptor(); });
  if (!parts.empty()) place.CopyFrom(*parts[Pick(parts.size())]);
}

void MessageMutator::MutateSlot(const Slot& slot) {
  if (slot.field->is_repeated()) {
    MutateRepeated(slot);
  } else {
    MutateSingular(slot);
  }
}

void MessageMutator::MutateRepeated(const Slot& slot) {
  const Reflection* reflection = slot.message->GetReflection();
  const int size = reflection->FieldSize(*slot.message, slot.field);
  const auto any = [&] { return static_cast<int>(Pick(static_cast<std::size_t>(size))); };
  if (size == 0) return AddElement(slot);
  switch (Pick(6)) {
    case 0:
      return size < kLongestList ? AddElement(slot) : SetElement(slot, any());
    case 1:
      reflection->SwapElements(slot.message, slot.field, any(), size - 1);
      return reflection->RemoveLast(slot.message, slot.field);
    case 2:
      return reflection->SwapElements(slot.message, slot.field, any(), any());
    case 3:
      if (slot.field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE && size < kLongestList) {
        Message* added = reflection->AddMessage(slot.message, slot.field);
        added->CopyFrom(reflection->GetRepeatedMessage(*slot.message, slot.field, any()));
        return;
      }
      return SetElement(slot, any());
    default:
      return SetElement(slot, any());
  }
}

void MessageMutator::AddElement(const Slot& slot) {
  const Reflection* r = slot.message->GetReflection();
  Message* m = slot.message;
  const FieldDescriptor* f = slot.field;
  switch (f->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return r->AddInt32(m, f, static_cast<std::int32_t>(NewInteger(0)));
    case FieldDescriptor::CPPTYPE_INT64:
      return r->AddInt64(m, f, NewInteger(0));
    case FieldDescriptor::CPPTYPE_UINT32:
      return r->AddUInt32(m, f, static_cast<std::uint32_t>(NewInteger(0)));
    case FieldDescriptor::CPPTYPE_UINT64:
      return r->AddUInt64(m, f, static_cast<std::uint64_t>(NewInteger(0)));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return r->AddDouble(m, f, NewNumber(0));
    case FieldDescriptor::CPPTYPE_FLOAT:
      return r->AddFloat(m, f, static_cast<float>(NewNumber(0)));
    case FieldDescriptor::CPPTYPE_BOOL:
      return r->AddBool(m, f, OneIn(2));
    case FieldDescriptor::CPPTYPE_ENUM:
      return r->AddEnumValue(m, f, NewEnum(*f));
    case FieldDescriptor::CPPTYPE_STRING:
      return r->AddString(m, f,
                          f->type() == FieldDescriptor::TYPE_BYTES ? NewBytes("") : NewText(""));
    case FieldDescriptor::CPPTYPE_MESSAGE:
      r->AddMessage(m, f);
      return;
  }
}

void MessageMutator::SetElement(const Slot& slot, int i) {
  const Reflection* r = slot.message->GetReflection();
  Message* m = slot.message;
  const FieldDescriptor* f = slot.field;
  switch (f->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return r->SetRepeatedInt32(
          m, f, i, static_cast<std::int32_t>(NewInteger(r->GetRepeatedInt32(*m, f, i))));
    case FieldDescriptor::CPPTYPE_INT64:
      return r->SetRepeatedInt64(m, f, i, NewInteger(r->GetRepeatedInt64(*m, f, i)));
    case FieldDescriptor::CPPTYPE_UINT32:
      return r->SetRepeatedUInt32(
          m, f, i, static_cast<std::uint32_t>(NewInteger(r->GetRepeatedUInt32(*m, f, i))));
    case FieldDescriptor::CPPTYPE_UINT64:
      return r->SetRepeatedUInt64(m, f, i, static_cast<std::uint64_t>(NewInteger(1)));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return r->SetRepeatedDouble(m, f, i, NewNumber(r->GetRepeatedDouble(*m, f, i)));
    case FieldDescriptor::CPPTYPE_FLOAT:
      return r->SetRepeatedFloat(
          m, f, i,
          static_cast<float>(NewNumber(static_cast<double>(r->GetRepeatedFloat(*m, f, i)))));
    case FieldDescriptor::CPPTYPE_BOOL:
      return r->SetRepeatedBool(m, f, i, !r->GetRepeatedBool(*m, f, i));
    case FieldDescriptor::CPPTYPE_ENUM:
      return r->SetRepeatedEnumValue(m, f, i, NewEnum(*f));
    case FieldDescriptor::CPPTYPE_STRING: {
      const std::string old = r->GetRepeatedString(*m, f, i);
      const bool is_bytes = f->type() == FieldDescriptor::TYPE_BYTES;
      return r->SetRepeatedString(m, f, i, is_bytes ? NewBytes(old) : NewText(old));
    }
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return Mutate(*r->MutableRepeatedMessage(m, f, i));
  }
}

void MessageMutator::MutateSingular(const Slot& slot) {
  const Reflection* r = slot.message->GetReflection();
  Message* m = slot.message;
  const FieldDescriptor* f = slot.field;
  if (r->HasField(*m, f) && OneIn(8)) return r->ClearField(m, f);
  switch (f->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return r->SetInt32(m, f, static_cast<std::int32_t>(NewInteger(r->GetInt32(*m, f))));
    case FieldDescriptor::CPPTYPE_INT64:
      return r->SetInt64(m, f, NewInteger(r->GetInt64(*m, f)));
    case FieldDescriptor::CPPTYPE_UINT32:
      return r->SetUInt32(m, f, static_cast<std::uint32_t>(NewInteger(r->GetUInt32(*m, f))));
    case FieldDescriptor::CPPTYPE_UINT64:
      return r->SetUInt64(m, f, static_cast<std::uint64_t>(NewInteger(1)));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return r->SetDouble(m, f, NewNumber(r->GetDouble(*m, f)));
    case FieldDescriptor::CPPTYPE_FLOAT:
      return r->SetFloat(m, f,
                         static_cast<float>(NewNumber(static_cast<double>(r->GetFloat(*m, f)))));
    case FieldDescriptor::CPPTYPE_BOOL:
      return r->SetBool(m, f, !r->GetBool(*m, f));
    case FieldDescriptor::CPPTYPE_ENUM:
      return r->SetEnumValue(m, f, NewEnum(*f));
    case FieldDescriptor::CPPTYPE_STRING: {
      const std::string old = r->GetString(*m, f);
      const bool is_bytes = f->type() == FieldDescriptor::TYPE_BYTES;
      return r->SetString(m, f, is_bytes ? NewBytes(old) : NewText(old));
    }
    case FieldDescriptor::CPPTYPE_MESSAGE:
      r->MutableMessage(m, f);  // sets it; its own fields are separate slots
      return;
  }
}

}  // namespace graspdb::fuzz
