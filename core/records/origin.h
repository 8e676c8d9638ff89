// Where a record comes from, kept once for all records of one build.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

namespace isoline {

using Json = nlohmann::json;
class JsonView;

// Version, commit, compiler, processor, libraries, …, which the records of one build share in
// memory; and "run", which is each one's own. Used as the JSON object that they are together.
class Provenance {
 public:
  Provenance() = default;
  Provenance(const Json& json);
  Provenance(Json::initializer_list_t list) : Provenance(Json(list)) {}
  Provenance(std::shared_ptr<const Json> build, Json run)
      : build_(std::move(build)), run_(std::move(run)) {}

  operator Json() const { return json(); }
  Json json() const;
  bool is_object() const { return build_ == nullptr || build_->is_object(); }
  bool contains(const std::string& key) const { return find(key) != end(); }
  const Json* find(const std::string& key) const;
  const Json* end() const { return nullptr; }
  const Json& operator[](const std::string& key) const { return *find(key); }
  Json& operator[](const std::string& key);  // no longer shares the build but for "run"

 private:
  std::shared_ptr<const Json> build_;  // none: an empty object
  Json run_;                           // null: none
};

// Shares the build with all that this thread reads.
Provenance provenance_from(const JsonView& json);

}  // namespace isoline
