// Places in a tree of nlohmann-json.
#include "core/records/json_place.h"

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "core/text.h"

namespace isoline {

JsonPlace JsonPlace::operator[](std::string_view member) const {
  return JsonPlace((*here_)[std::string(member)]);
}
JsonPlace JsonPlace::next() const {
  here_->push_back(nullptr);
  return JsonPlace(here_->back());
}
void JsonPlace::make_object() const { *here_ = Json::object(); }
void JsonPlace::make_list() const { *here_ = Json::array(); }
void JsonPlace::set_null() const { *here_ = nullptr; }
void JsonPlace::set(bool value) const { *here_ = value; }
void JsonPlace::set(std::int64_t value) const { *here_ = value; }
void JsonPlace::set(std::uint64_t value) const { *here_ = value; }
void JsonPlace::set(std::string_view value) const { *here_ = valid_utf8(value); }
void JsonPlace::set(Real value) const { *here_ = json_number(value); }
void JsonPlace::set(std::span<const Real> values) const { *here_ = json_numbers(values); }
void JsonPlace::set(Json value) const { *here_ = std::move(value); }

void JsonPlace::parse(std::string_view text) const { *here_ = Json::parse(text); }
void JsonPlace::include(std::string_view text) const { here_->update(Json::parse(text)); }
void JsonPlace::restrict(std::string_view law) const {
  if (here_->contains("$ref"))
    *here_ = {{"allOf", {*here_, Json::parse(law)}}};
  else
    include(law);
}

}  // namespace isoline
