// Where the results come from: builds, machines, commands.
#include <fmt/format.h>

#include <set>

#include "core/json.h"
#include "reports/html/html.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline::reports {
namespace {

std::string libraries_of(const Build& build) {
  std::string text;
  for (const auto& [name, version] : build.libraries)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, version);
  return text;
}

// The lines of one build; equal ones are told once.
std::string build_html(const Build& build) {
  const auto line = [](const char* term, const std::string& text) {
    if (text.empty()) return std::string();
    return fmt::format("<dt>{}</dt><dd>{}</dd>\n", term, html_text(text));
  };
  const bool is_changed = build.is_dirty.value_or(false) && !build.commit.empty();
  const std::string compiled =
      build.compiler.empty() ? build.flags : build.compiler + "  " + build.flags;
  const std::string cores = build.cores > 0 ? fmt::format(", {} cores", build.cores) : "";
  return line("version", build.version) +
         line("commit", build.commit + (is_changed ? " with uncommitted changes" : "")) +
         line("compiler", compiled) + line("build", build.build_type) +
         line("instructions", build.instruction_set) + line("processor", build.processor + cores) +
         line("system", build.system) + line("libraries", libraries_of(build));
}

}  // namespace

std::string provenance_html(const Comparison& c) {
  constexpr std::size_t kMostBuilds = 8;
  std::set<std::string> builds, commands;
  std::set<const Build*> seen;
  for (const Run& run : c.runs) {
    const Provenance& provenance = run.record->provenance;
    const bool is_new = seen.insert(provenance.build.get()).second;  // one for records of a build
    if (is_new && builds.size() <= kMostBuilds) builds.insert(build_html(*provenance.build));
    if (commands.size() <= kMostBuilds) commands.insert(provenance.run.command);
  }
  commands.erase("");
  std::string html;
  for (const std::string& build : builds) html += fmt::format("<dl>{}</dl>\n", build);
  for (const std::string& command : commands)
    html += fmt::format("<p>Asked for by <code>{}</code></p>\n", html_text(command));
  if (!c.runs.empty())
    html += fmt::format(
        "<p>One cell again: <code>{}</code></p>\n<p>The command of every other cell: <a "
        "href=\"#details\">All cells</a>, button <i>copy</i>, or column "
        "<code>command</code> of <code>report.csv</code>.</p>\n",
        html_text(rerun_command(c.runs[0].record->request)));
  return html;
}

}  // namespace isoline::reports
