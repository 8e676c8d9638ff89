// A comparison as Markdown, for the summary of a job.
#include <fmt/format.h>

#include "reports/compare/gate_words.h"
#include "reports/formats/escape.h"

namespace isoline::reports {
namespace {

std::string markdown_list(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return "";
  std::string text = fmt::format("\n<details><summary>{} ({})</summary>\n\n", title, lines.size());
  for (const std::string& line : lines) text += "- " + markdown_text(line) + "\n";
  return text + "\n</details>\n";
}

std::string markdown_times(const std::vector<TimeVerdict>& times) {
  if (times.empty()) return "";
  std::string text =
      "\n| time | cell | ratio (95 % interval) | noise | p, adjusted | runs |\n"
      "|---|---|---:|---:|---:|---:|\n";
  for (const TimeVerdict& time : times)
    text += fmt::format("| {} | {} | {} | {} | {:.2g} | {}, {} |\n", name_of_time(time.change),
                        markdown_text(time.title), ratio_text(time.ratio), noise_text(time),
                        time.adjusted, time.n_before, time.n_after);
  return text;
}

}  // namespace

std::string gate_markdown(const GateResult& result) {
  std::string text =
      fmt::format("# Comparison: {}\n\n{}.\n", markdown_text(result.verdict), headline_of(result));
  if (!result.differences.empty())
    text += "\n|  | cell | figure | BASE | NEW | change |\n|---|---|---|---:|---:|---|\n";
  for (const Difference& d : result.differences)
    text +=
        fmt::format("| {} | {} | {} | {} | {} | {} |\n", name_of(d.change), markdown_text(d.title),
                    d.what, markdown_text(d.before), markdown_text(d.after), remainder_text(d));
  text += markdown_times(result.times);
  if (!result.remarks.empty()) text += "\n";
  for (const std::string& remark : result.remarks) text += "- " + markdown_text(remark) + "\n";
  return text + markdown_list("Not comparable", lines_of(result.incomparable)) +
         markdown_list(kOnlyBefore, result.only_before) +
         markdown_list(kOnlyAfter, result.only_after);
}

}  // namespace isoline::reports
