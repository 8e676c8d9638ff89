// Plain text within the columns of its reader: the ranking and the best method of each problem,
// every cell of a small study, and any section.
#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <vector>

#include "core/columns.h"
#include "core/seeds.h"
#include "reports/formats/formats.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

constexpr std::size_t kFewCells = 40;   // so many are shown in full
constexpr std::size_t kMostNames = 40;  // characters of a name before it is cut

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

std::string name_of_spec(const std::string& spec) {
  std::string name = terminal_text(shown_spec(spec));
  return name.size() > kMostNames ? name.substr(0, kMostNames - 3) + "..." : name;
}

std::string label_of(const OptimizerAxis& optimizer) {
  return name_of_spec(optimizer.label) + (optimizer.is_foreign ? " ‡" : "") + marks_of(optimizer);
}

std::string label_of(const ProblemAxis& problem) {
  return name_of_spec(problem.label.empty() ? problem.spec : problem.label) +
         (problem.is_foreign ? " ‡" : "");
}

std::string wrapped(const std::string& text, std::size_t columns) {
  return fitted_text(text, columns) + "\n";
}

// "sine             sip † 2", two a line where they fit. Empty if no least loss is known.
std::string best_of_each(const Comparison& c, const Columns& columns) {
  if (std::ranges::all_of(c.problems, &ProblemAxis::lacks_least_loss)) return "";
  std::vector<std::string> lines;
  std::size_t width = 0, longest = 0;
  for (const ProblemAxis& problem : c.problems)
    width = std::max(width, width_of(label_of(problem)));
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    const std::vector<std::size_t> order = ranking(c, p);
    const bool is_solved = !order.empty() && c.cell(p, order[0]).headline[kTightest].is_solved();
    const std::string best = is_solved ? fmt::format("{} {}", label_of(c.optimizers[order[0]]),
                                                     matrix_text(c, c.cell(p, order[0]), kTightest))
                             : c.problems[p].lacks_least_loss() ? "least loss unknown"
                                                                : "none";
    lines.push_back("  " + left(label_of(c.problems[p]), width) + "  " + best);
    longest = std::max(longest, width_of(lines.back()));
    if (width_of(lines.back()) > columns.table)
      lines.back() = "  " + label_of(c.problems[p]) + "\n    " + best;
  }
  const std::size_t half = 2 * longest + 2 <= columns.prose ? (lines.size() + 1) / 2 : lines.size();
  std::string text = fmt::format("\nSmallest median {}\n", counted_to_tau(c));
  for (std::size_t i = 0; i < half; ++i) {
    const bool is_pair = half < lines.size() && i + half < lines.size();
    text += (is_pair ? left(lines[i], longest + 2) + lines[i + half] : lines[i]) + "\n";
  }
  return text + "\n" + wrapped(success_text(c), columns.prose);
}

std::string line_of(const Comparison& c, std::size_t p, std::size_t s, std::size_t width) {
  const Cell& cell = c.cell(p, s);
  std::string line = "  " + left(label_of(c.optimizers[s]), width);
  if (cell.runs.empty()) return line + "  missing\n";
  if (!cell.is_measured()) return line + "  n/a: " + terminal_text(cell.inapplicable) + "\n";
  const Spread& work = cell.headline[kTightest];
  const bool is_unknown = c.problems[p].lacks_least_loss();
  line += right(is_unknown ? "?" : fmt::format("{}/{}", work.n - work.unsolved, work.n), 6) + "  ";
  for (std::size_t t = 0; t < kTolerances.size(); ++t)
    line += right(matrix_text(c, cell, t) + (cell.is_best[t] ? "*" : " "), 8);
  const Spread& seconds = cell.taken[Measure::time][kTightest];
  const bool is_marked = !cell.is_timed_alone && seconds.is_solved();
  line += right((is_unknown ? "?" : milliseconds(seconds.median)) + (is_marked ? "≈" : " "), 9);
  return line + right(reached_figure(cell.loss.median), 11) + "  " + status_text(cell.statuses) +
         "\n";
}

std::string every_cell(const Comparison& c, std::size_t columns) {
  std::size_t width = 10;
  for (const OptimizerAxis& each : c.optimizers) width = std::max(width, width_of(label_of(each)));
  std::string text;
  for (std::size_t p = 0; p < c.problems.size(); ++p) {
    text +=
        fmt::format("\n{}\n{}", terminal_text(problem_name(c.problems[p])), left("", width + 2));
    text += "  runs  ";
    for (std::size_t t = 0; t < kTolerances.size(); ++t)
      text += right(fmt::format("{}{} ", t == 0 ? "to " : "", c.yardstick.tolerances[t].name), 8);
    text += "      ms         loss  status\n";
    for (const std::size_t s : ranking(c, p)) text += line_of(c, p, s, width);
    for (std::size_t s = 0; s < c.optimizers.size(); ++s)
      if (c.cell(p, s).planned > 0 && !c.cell(p, s).is_measured()) text += line_of(c, p, s, width);
  }
  std::string marks = fmt::format(
      "runs: how many of the runs reached {}. Columns of tolerances: the median {} needed to reach "
      "the tolerance, in {}. ms: the median wall time needed to reach {}. loss: the median final "
      "loss. {} *: the smallest value for its problem; ✗: at most half of the runs reached the "
      "tolerance; n/a: not applicable",
      tau_name(c), counted_name(c), unit_name(c), tau_name(c), success_text(c));
  if (std::ranges::any_of(c.problems, &ProblemAxis::lacks_least_loss))
    marks += "; ?: least loss unknown";
  if (c.is_any_timed_together) marks += "; ≈: timed while other runs used the machine";
  return text + "\n" + wrapped(marks + ".", columns);
}

std::string failure_lines(const Comparison& c, std::size_t columns) {
  constexpr std::size_t kMost = 10;
  std::vector<std::string> lines;
  for (const std::size_t run : c.failures) {
    const Record& record = *c.runs[run].record;
    lines.push_back(fmt::format("{}: {} / {} / seed {}: {}", name_of(record.status),
                                record.request.problem.spec, record.request.optimizer.spec,
                                seed_text(record.request.seed), record.message));
  }
  for (const Unreadable& file : c.study->unreadable)
    lines.push_back(fmt::format("unreadable: {}: {}", file.file, file.reason));
  std::string text;
  for (std::size_t i = 0; i < lines.size() && i < kMost; ++i)
    text += wrapped(terminal_text(lines[i]), columns);
  if (lines.size() > kMost) text += fmt::format("and {} more\n", lines.size() - kMost);
  return text.empty() ? "" : "\n" + text;
}

// Rows that may still be printed, over all tables of a section; and how many were not.
struct RowLimit {
  std::size_t left = kAllRows, hidden = 0;

  std::size_t take(std::size_t wanted) {
    const std::size_t taken = std::min(left, wanted);
    left -= taken;
    hidden += wanted - taken;
    return taken;
  }
};

// Columns of a table below each other, as wide as they must be.
std::string block(const Table& table, const Part& part, std::size_t rows) {
  std::vector<std::vector<std::string>> lines(1);
  for (const std::size_t i : part) lines[0].push_back(terminal_text(table.columns[i]));
  for (const auto& row : std::span(table.rows).first(rows)) {
    auto& line = lines.emplace_back();
    const bool is_short = row.size() < table.columns.size();
    for (const std::size_t i : part)
      if (i < table.names || !is_short) line.push_back(terminal_text(row[i].text));
    if (is_short) line.push_back(terminal_text(row.back().text));
  }
  std::vector<std::size_t> widths(part.size(), 0);
  for (const auto& line : lines)
    for (std::size_t i = 0; i < line.size() && (i == 0 || line.size() == part.size()); ++i)
      widths[i] = std::max(widths[i], width_of(line[i]));
  std::string text;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i)
      text += i + 1 < line.size() ? left(line[i], widths[i]) + "  " : line[i];
    text.erase(text.find_last_not_of(' ') + 1);
    text += "\n";
  }
  return text + "\n";
}

// A row of sentences as a paragraph.
std::string paragraph(const Table& table, std::size_t row) {
  const auto& cells = table.rows[row];
  const std::string id = row < table.row_topics.size() ? table.row_topics[row].claim : "";
  std::string text =
      fmt::format("{}{}\n", id.empty() ? "" : id + ": ", terminal_text(cells[0].text));
  if (!cells[0].remark.empty()) text += "  " + terminal_text(cells[0].remark) + "\n";
  for (std::size_t i = 1; i < cells.size(); ++i)
    if (!cells[i].text.empty())
      text += fmt::format("  {}: {}\n", table.columns[i], terminal_text(cells[i].text));
  return text;
}

// The columns of a part in so many pieces that each has room, all with the names of the rows.
std::vector<Part> pieces_of(const Table& table, const Part& part, std::size_t rows,
                            std::size_t columns) {
  const auto width = [&](std::size_t i) {
    std::size_t most = width_of(terminal_text(table.columns[i]));
    for (const auto& row : std::span(table.rows).first(rows))
      if (i < row.size() && row.size() == table.columns.size())
        most = std::max(most, width_of(terminal_text(row[i].text)));
    return most + 2;
  };
  const Part names(part.begin(), part.begin() + std::ptrdiff_t(std::min(table.names, part.size())));
  std::size_t taken = 0;
  for (const std::size_t i : names) taken += width(i);
  std::vector<Part> pieces = {names};
  std::size_t at = taken;
  for (std::size_t k = names.size(); k < part.size(); ++k) {
    if (at + width(part[k]) - 2 > columns && pieces.back().size() > names.size()) {
      pieces.push_back(names);
      at = taken;
    }
    pieces.back().push_back(part[k]);
    at += width(part[k]);
  }
  return pieces;
}

std::string table_text(const Table& table, RowLimit& limit, const Columns& columns) {
  std::string body;
  std::size_t shown = 0;  // columns, whose meanings follow
  if (table.is_wordy()) {
    const std::size_t rows = limit.take(table.rows.size());
    for (std::size_t row = 0; row < rows; ++row) body += paragraph(table, row);
  } else {
    for (const Part& part : table_parts(table, table.columns.size())) {
      const std::size_t rows = limit.take(table.rows.size());
      if (rows == 0 && !table.rows.empty()) continue;
      for (const Part& piece : pieces_of(table, part, rows, columns.table))
        body += block(table, piece, rows);
      shown = part.back() + 1;
    }
  }
  if (body.empty()) return "";
  std::string text = table.title.empty() ? "" : terminal_text(table.title) + "\n";
  if (!table.reading.empty()) text += wrapped(terminal_text(table.reading), columns.prose);
  text += body;
  for (std::size_t i = 1; i < std::min(shown, table.meanings.size()); ++i)
    text += fmt::format("  {}: {}\n", table.columns[i], table.meanings[i]);
  return text + (table.caption.empty() ? "" : wrapped(table.caption, columns.prose));
}

std::string table_text(const Table& table, const Columns& columns) {
  RowLimit all;
  return table_text(table, all, columns);
}

}  // namespace

std::string terminal_section(const Section& section, std::size_t most_rows,
                             const Columns& columns) {
  if (section.is_empty()) return section.otherwise + "\n";
  std::string text;
  for (const Reading& reading : section.readings)
    text +=
        wrapped((reading.title.empty() ? "" : reading.title + ": ") + terminal_text(reading.text),
                columns.prose);
  if (!section.lead.empty()) text += wrapped(section.lead, columns.prose);
  RowLimit limit{.left = most_rows};
  for (const Table& table : section.tables) {
    if (const std::string its = table_text(table, limit, columns); !its.empty()) text += "\n" + its;
    while (text.ends_with("\n\n")) text.pop_back();
  }
  if (limit.hidden == 0) return text;
  return text + fmt::format("… and {} more row{}; --all lists them\n", limit.hidden,
                            limit.hidden == 1 ? "" : "s");
}

std::string terminal_claim(const Section& claim, const Columns& columns) {
  std::string text = wrapped(terminal_text(claim.title), columns.prose) + "\n";
  for (const Reading& reading : claim.readings)
    text +=
        wrapped(fmt::format("{}: {}", reading.title, terminal_text(reading.text)), columns.prose);
  text += "\n";
  constexpr std::size_t kFewRuns = 24;
  for (const Table& table : claim.tables)
    text += table.is_folded && table.rows.size() > kFewRuns
                ? fmt::format("{}: {}; --json lists them with their records.\n\n", table.title,
                              table.rows.size())
                : table_text(table, columns);
  return text + (claim.command.empty() ? "" : fmt::format("To repeat it: {}\n", claim.command));
}

std::string terminal_table(const Document& document) { return terminal_table(document, {}); }

std::string terminal_table(const Document& document, const Columns& columns) {
  const Comparison& c = document.comparison;
  std::size_t cells = 0;
  for (const auto& row : c.cells)
    cells += static_cast<std::size_t>(
        std::ranges::count_if(row, [](const Cell& cell) { return cell.planned > 0; }));
  const std::vector<Table>& tables = document.section("standings").tables;
  const auto own = std::ranges::find(document.sections, "fit", &Section::id);
  const bool is_one_fit = own != document.sections.end() && c.problems.size() == 1;
  std::string text = is_one_fit ? terminal_section(*own, kFewRows, columns) + "\n" : "";
  text += wrapped(document.headline, columns.prose);
  if (!document.incomplete.empty())
    text += wrapped("INCOMPLETE: " + terminal_text(document.incomplete), columns.prose);
  if (cells <= kFewCells)
    text += every_cell(c, columns.prose);
  else
    text += "\n" + (tables.empty() ? "" : table_text(tables[0], columns)) +
            best_of_each(c, columns) + "\n";
  for (const Reading& sentence : document.section("standings").readings)
    text += wrapped(terminal_text(sentence.text), columns.prose);
  const Section& claims = document.section("claims");
  if (!is_one_fit && (!c.study->plan.suites.empty() || !document.claims.empty()))
    text += wrapped(claims.readings.empty() ? claims.otherwise : claims.readings[0].text,
                    columns.prose);
  if (const std::string legend = marks_legend(c); !legend.empty())
    text += wrapped(legend, columns.prose);
  return text + failure_lines(c, columns.prose);
}

}  // namespace isoline::reports
