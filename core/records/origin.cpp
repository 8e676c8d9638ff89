// The provenance of a record as JSON and back.
#include "core/records/origin.h"

#include <fmt/format.h>

#include <unordered_map>

#include "core/records/json_view.h"

namespace isoline {
namespace {

constexpr const char* kRun = "run";

}  // namespace

Provenance::Provenance(const Json& json) {
  Json build = json;
  if (json.is_object() && json.contains(kRun)) {
    run_ = json[kRun];
    build.erase(kRun);
  }
  build_ = std::make_shared<const Json>(std::move(build));
}

Json Provenance::json() const {
  Json json = build_ == nullptr ? Json::object() : *build_;
  if (!run_.is_null()) json[kRun] = run_;
  return json;
}

const Json* Provenance::find(const std::string& key) const {
  if (key == kRun) return run_.is_null() ? nullptr : &run_;
  if (build_ == nullptr || !build_->is_object()) return nullptr;
  const auto found = build_->find(key);
  return found == build_->end() ? nullptr : &*found;
}

Json& Provenance::operator[](const std::string& key) {
  if (key == kRun) return run_;
  const auto own = std::make_shared<Json>(build_ == nullptr ? Json::object() : *build_);
  build_ = own;
  return (*own)[key];
}

// One copy of each build's part for all records that a thread reads.
Provenance provenance_from(const JsonView& json) {
  constexpr std::size_t kMostBuilds = 1000;
  static thread_local std::unordered_map<std::string, std::shared_ptr<const Json>> builds;
  std::string text;
  Json run;
  for (const auto& [key, value] : json.items())
    if (key == kRun)
      run = value.json();
    else
      text += fmt::format("{}:{},", key, value.text());
  if (builds.size() > kMostBuilds) builds.clear();
  std::shared_ptr<const Json>& build = builds[text];
  if (build == nullptr) {
    Json copy = json.json();
    copy.erase(kRun);
    build = std::make_shared<const Json>(std::move(copy));
  }
  return {build, std::move(run)};
}

}  // namespace isoline
