// Named entries of one kind of component, ordered by name, so that every listing is reproducible.
#pragma once

#include <map>
#include <source_location>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/text.h"

namespace isoline {

// Entry has a member `name`, and may have `file`, the file that registers it, and `needs_argument`,
// how to write a spec if the name alone is not sufficient.
template <class Entry>
class Registry {
 public:
  explicit Registry(std::string kind) : kind_(std::move(kind)) {}

  void add(Entry entry, const std::source_location& here = std::source_location::current()) {
    const std::string name = entry.name;
    if constexpr (requires { entry.file = here.file_name(); }) entry.file = here.file_name();
    const bool is_new = entries_.emplace(name, std::move(entry)).second;
    require(is_new, [&] { return "the " + kind_ + " '" + name + "' is registered twice"; });
  }
  const Entry& at(const std::string& name) const {
    const auto found = entries_.find(name);
    require(found != entries_.end(), [&] { return unknown_name(kind_, name, names()); });
    return found->second;
  }
  bool contains(const std::string& name) const { return entries_.contains(name); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, entry] : entries_) all.push_back(name);
    return all;
  }
  // The entries that can be created from their name alone.
  Registry ready() const {
    Registry all(kind_);
    for (const auto& [name, entry] : entries_)
      if (entry.needs_argument.empty()) all.entries_.emplace(name, entry);
    return all;
  }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }
  std::size_t size() const { return entries_.size(); }

 private:
  std::string kind_;
  std::map<std::string, Entry> entries_;
};

}  // namespace isoline
