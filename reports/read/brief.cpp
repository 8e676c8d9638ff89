// Leaves out of long labels what is common to all of a method.
#include "reports/read/brief.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/errors.h"
#include "core/spec.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kLong = 24;  // letters: a shorter label is shown as it is

// "sip[inverse=newton], tuned" is a spec and what follows it.
struct Label {
  Spec spec;
  std::string rest;
};

// What is no spec, as of records that someone else wrote, has no options to leave out.
Label label_of(const std::string& text) {
  const std::size_t close = text.rfind(']');
  const std::size_t end = close == std::string::npos ? text.find(',') : close + 1;
  const std::string spec = text.substr(0, end);
  try {
    return {parse_spec(spec), text.substr(spec.size())};
  } catch (const UsageError&) {
    return {{.name = text, .options = {}}, ""};
  }
}

using Option = std::pair<std::string, std::string>;

std::set<Option> common_to(const std::vector<Label>& labels) {
  const auto& first = labels.front().spec.options;
  std::set<Option> common(first.begin(), first.end());
  for (const Label& label : labels)
    std::erase_if(common, [&](const Option& option) {
      return std::ranges::find(label.spec.options, option) == label.spec.options.end();
    });
  return common;
}

std::string text_of(const Label& label, const std::set<Option>& left_out) {
  std::string options;
  for (const Option& option : label.spec.options)
    if (!left_out.contains(option))
      options += (options.empty() ? "" : ",") + option.first + "=" + option.second;
  return label.spec.name + (options.empty() ? "" : "[" + options + "]") + label.rest;
}

}  // namespace

std::vector<std::string> brief_labels(const std::vector<std::string>& labels) {
  std::map<std::string, std::vector<Label>> methods;
  for (const std::string& label : labels) {
    const Label parsed = label_of(label);
    methods[parsed.spec.name].push_back(parsed);
  }
  std::vector<std::string> brief;
  std::map<std::string, int> count;
  for (const std::string& label : labels) {
    const Label parsed = label_of(label);
    brief.push_back(label.size() <= kLong ? label
                                          : text_of(parsed, common_to(methods[parsed.spec.name])));
    ++count[brief.back()];
  }
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (count[brief[i]] > 1) brief[i] = labels[i];
  return brief;
}

}  // namespace isoline::reports
