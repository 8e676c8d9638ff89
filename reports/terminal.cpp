// The main table as plain text, about a hundred columns wide.
#include <fmt/format.h>

#include <algorithm>

#include "reports/report.h"
#include "reports/text.h"
#include "reports/wording.h"

namespace isoline {
namespace {

// Characters, not bytes: what a column holds.
std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char letter) { return (static_cast<unsigned char>(letter) & 0xC0) != 0x80; }));
}

std::string left(std::string text, std::size_t width) {
  while (width_of(text) < width) text += ' ';
  return text;
}
std::string right(std::string text, std::size_t width) {
  const std::size_t own = width_of(text);
  return std::string(width > own ? width - own : 0, ' ') + std::move(text);
}

// No escape sequence from a record reaches the terminal.
std::string printable(std::string text) {
  for (char& letter : text)
    if (static_cast<unsigned char>(letter) < ' ' || letter == 127) letter = '?';
  return text;
}

std::string line_of(const Comparison& c, std::size_t p, std::size_t s, std::size_t name_width) {
  const Cell& cell = c.cell(p, s);
  const std::string mark = cell.privileges.empty() ? "" : " †";
  std::string line = "  " + left(printable(c.optimizers[s].label) + mark, name_width);
  if (cell.runs.empty()) return line + "  missing\n";
  if (!cell.is_measured()) return line + "  n/a: " + printable(cell.inapplicable) + "\n";
  line += right(fmt::format("{}/{}", cell.work[kTightest].n - cell.work[kTightest].unsolved,
                            cell.work[kTightest].n),
                7);
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    line += right(reached_figure(cell.work[t].median) + (cell.is_best[t] ? "*" : " "),
                  t == 0 ? 12 : 10);
  const Spread& seconds = cell.seconds[kTightest];
  const bool is_marked = !cell.is_timed_alone && seconds.is_solved();
  line += right(milliseconds(seconds.median) + (is_marked ? "≈" : " "), 12);
  line += right(reached_figure(cell.loss.median), 11);
  line += right(cell.x_error.n == 0 ? "" : reached_figure(cell.x_error.median), 11);
  return line + "  " + status_text(cell.statuses) + "\n";
}

std::string header_of(const Comparison& c, std::size_t p, std::size_t name_width) {
  const std::string name = printable(c.problems[p].spec);
  std::string line = fmt::format("\n{}", left(name, name_width + 2));
  if (width_of(name) > name_width + 2) line.append("\n").append(name_width + 2, ' ');
  line += right("reach", 7) + right("work 1e-1 ", 12) + right("1e-3 ", 10) + right("1e-6 ", 10);
  line += right("ms to 1e-6 ", 12) + right("loss", 11) + right("x error", 11);
  return line + "  status\n";
}

std::string failure_lines(const Comparison& c) {
  constexpr std::size_t kMost = 20;
  std::vector<std::string> lines;
  for (const std::size_t run : c.failures) {
    const Record& record = *c.runs[run].record;
    lines.push_back(fmt::format("{}: {} / {} / seed {}: {}", name_of(record.status),
                                record.request.problem.spec, record.request.optimizer.spec,
                                record.request.seed, record.message));
  }
  for (const Unreadable& file : c.study->unreadable)
    lines.push_back(fmt::format("unreadable: {}: {}", file.file.string(), file.reason));
  std::string text;
  for (std::size_t i = 0; i < lines.size() && i < kMost; ++i) text += printable(lines[i]) + "\n";
  if (lines.size() > kMost) text += fmt::format("and {} more\n", lines.size() - kMost);
  return text;
}

}  // namespace

std::string terminal_table(const Comparison& c) {
  std::size_t name_width = 10;
  for (const OptimizerAxis& optimizer : c.optimizers)
    name_width = std::max(name_width, width_of(optimizer.label) + 2);
  std::string text = headline(c) + "\n";
  if (!c.missing.empty()) text += "INCOMPLETE: " + printable(missing_text(c)) + "\n";
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    text += header_of(c, p, name_width);
    for (const std::size_t s : ranking(c, p)) text += line_of(c, p, s, name_width);
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).planned > 0 && !c.cell(p, s).is_measured())
        text += line_of(c, p, s, name_width);
  }
  text +=
      "\nMedians over seeds, work in forward solves; reach: runs that reach 1e-6 of all runs.\n"
      "* least of its problem, ✗ not reached by half of the runs";
  if (c.is_any_timed_together) text += ", ≈ timed beside other runs";
  return text + ", † sees what others do not.\n" + failure_lines(c);
}

}  // namespace isoline
