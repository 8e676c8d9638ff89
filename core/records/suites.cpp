// Names of suites with versions.
#include "core/records/suites.h"

#include <fmt/format.h>

#include "core/errors.h"

namespace isoline {
namespace {

std::string with_version(const std::string& suite) {
  return suite.find('@') == suite.npos ? suite + "@1" : suite;
}

std::string name_in(const std::string& suite) { return suite.substr(0, suite.find('@')); }

}  // namespace

void add_suite(std::vector<std::string>& suites, const std::string& suite) {
  for (std::string& known : suites) {
    if (name_in(known) != name_in(suite)) continue;
    require(with_version(known) == with_version(suite), [&] {
      return fmt::format(
          "results of {} and {} cannot be combined, since the settings of a suite differ between "
          "its versions; keep each version in its own folder, and report it alone",
          with_version(known), with_version(suite));
    });
    if (suite.size() > known.size()) known = suite;  // the one that states its version
    return;
  }
  suites.push_back(suite);
}

}  // namespace isoline
