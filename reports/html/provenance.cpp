// Where the results come from: builds, machines, commands.
#include <fmt/format.h>

#include <set>

#include "core/json.h"
#include "reports/html/html.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline::reports {
namespace {

// Text of any JSON value, "" where there is none.
std::string text_at(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  if (!json.is_object() || at == json.end()) return "";
  return at->is_string() ? at->get<std::string>() : at->dump();
}

std::string libraries_of(const Json& provenance) {
  std::string text;
  const auto libraries = provenance.find("libraries");
  if (libraries == provenance.end() || !libraries->is_object()) return text;
  for (const auto& [name, version] : libraries->items())
    text +=
        fmt::format("{}{} {}", text.empty() ? "" : ", ", name, text_at(*libraries, name.c_str()));
  return text;
}

// The lines of one build; equal ones are told once.
std::string build_html(const Json& provenance) {
  const auto line = [](const char* term, const std::string& text) {
    if (text.empty()) return std::string();
    return fmt::format("<dt>{}</dt><dd>{}</dd>\n", term, html_text(text));
  };
  if (!provenance.is_object()) return "";
  const bool is_dirty = text_at(provenance, "dirty") == "true";
  const std::string commit = text_at(provenance, "commit");
  const std::string compiler = text_at(provenance, "compiler");
  const std::string processor = text_at(provenance, "processor"),
                    cores = text_at(provenance, "cores");
  return line("version", text_at(provenance, "version")) +
         line("commit",
              commit.empty() || !is_dirty ? commit : commit + " with uncommitted changes") +
         line("compiler",
              compiler + (compiler.empty() ? "" : "  ") + text_at(provenance, "flags")) +
         line("build", text_at(provenance, "build_type")) +
         line("instructions", text_at(provenance, "instruction_set")) +
         line("processor", processor + (cores.empty() ? "" : ", " + cores + " cores")) +
         line("system", text_at(provenance, "system")) +
         line("libraries", libraries_of(provenance));
}

}  // namespace

std::string provenance_html(const Comparison& c) {
  constexpr std::size_t kMostBuilds = 8;
  std::set<std::string> builds, commands;
  std::set<const Json*> seen;
  for (const Run& run : c.runs) {
    const Provenance& provenance = run.record->provenance;
    const Json* version = provenance.find("version");  // one in memory for records of one build
    const bool is_new = version == nullptr || seen.insert(version).second;
    if (is_new && builds.size() <= kMostBuilds) builds.insert(build_html(provenance));
    if (provenance.is_object() && provenance.contains("run") && commands.size() <= kMostBuilds)
      commands.insert(text_at(provenance["run"], "command"));
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
