// The optimizers by family, and where the results come from.
#include <fmt/format.h>

#include <map>
#include <set>

#include "core/json.h"
#include "reports/html.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline {
namespace {

std::string family_title(const std::string& family) {
  static const std::map<std::string, std::string> kTitles = {
      {"first-order", "First order"},
      {"curvature", "Curvature"},
      {"inversion", "Inversion of the physics"},
      {"ceres", "Ceres"},
      {"nlopt", "NLopt, with gradients"},
      {"nlopt-derivative-free", "NLopt, without derivatives"}};
  const auto at = kTitles.find(family);
  return at == kTitles.end() ? family : at->second;
}

std::string optimizer_item(const OptimizerAxis& optimizer) {
  std::string html = fmt::format("<li><b>{}</b>", html_text(shown_spec(optimizer.label)));
  if (const Sheet* sheet = optimizer.sheet; sheet != nullptr)
    html +=
        fmt::format(" {} <span class=formula>{}</span> <cite>{}</cite>", html_text(sheet->title),
                    html_text(sheet->formula), html_text(sheet->source));
  html += fmt::format("<span class=count>solves {} of {} to 1e-6", optimizer.tightest().solved,
                      optimizer.planned);
  if (optimizer.applicable < optimizer.planned)
    html += fmt::format(" · applies to {}", optimizer.applicable);
  if (!optimizer.privileges.empty())
    html += fmt::format(" · <span class=privilege>† sees {}</span>",
                        html_text(fmt::format("{}", fmt::join(optimizer.privileges, ", "))));
  html += "</span>";
  return html + "</li>\n";
}

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
         line("instructions", text_at(provenance, "march")) +
         line("processor", processor + (cores.empty() ? "" : ", " + cores + " cores")) +
         line("system", text_at(provenance, "system")) +
         line("libraries", libraries_of(provenance));
}

}  // namespace

std::string families_html(const Comparison& c) {
  std::map<std::string, std::string> families;
  for (const OptimizerAxis& optimizer : c.optimizers) {
    const std::string family = optimizer.family();
    families[family.empty() ? "Others" : family] += optimizer_item(optimizer);
  }
  std::string html;
  for (const auto& [family, items] : families)
    html += fmt::format("<section class=family><h3>{}</h3>\n<ul>{}</ul></section>\n",
                        html_text(family_title(family)), items);
  return html;
}

std::string provenance_html(const Comparison& c) {
  constexpr std::size_t kMostBuilds = 8;
  std::set<std::string> builds, commands;
  for (const Run& run : c.runs) {
    const Json& provenance = run.record->provenance;
    if (builds.size() <= kMostBuilds) builds.insert(build_html(provenance));
    if (provenance.is_object() && provenance.contains("run") && commands.size() <= kMostBuilds)
      commands.insert(text_at(provenance["run"], "command"));
  }
  commands.erase("");
  std::string html;
  for (const std::string& build : builds) html += fmt::format("<dl>{}</dl>\n", build);
  for (const std::string& command : commands)
    html += fmt::format("<p>Asked for by <code>{}</code></p>\n", html_text(command));
  if (!c.runs.empty())
    html += fmt::format("<p>One cell again: <code>{}</code></p>\n",
                        html_text(rerun_command(c.runs[0].record->request)));
  return html;
}

}  // namespace isoline
