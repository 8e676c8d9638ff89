// Words for the figures of a claim.
#include "reports/sections/claim_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/sections/run_figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

const char* words_of_source(const std::string& from) {
  if (from == "text") return "from text";
  return from == "digitized" ? "off a digitized curve" : "off a figure";
}

std::string tolerance_text(const Json& tolerance) {
  const std::string from = tolerance.at("from");
  const bool is_ratio = tolerance.value("values", 1) == 2;
  if (from == "none") return "no error stated";
  if (from == "digits")
    return fmt::format("±{} in its digits", figure(real_of(tolerance["absolute"])));
  const Real t = real_of(tolerance["relative"]);
  std::string of_one = fmt::format("±{:.0f} % {}", 100 * t, words_of_source(from));
  if (!is_ratio) return of_one;
  // The law of agreement.cpp for a ratio of two readings.
  return fmt::format("{}, each value: {:+.0f} to {:+.0f} %", of_one, 100 * ((1 - t) / (1 + t) - 1),
                     100 * ((1 + t) / (1 - t) - 1));
}

std::string iteration_text(const Json& from, const char* otherwise) {
  if (!from.contains("iteration")) return otherwise;
  return fmt::format("at iteration {}", from["iteration"].get<std::int64_t>());
}

std::string term_text(const Json& term) {
  const Json& optimizer = term.at("optimizer");
  std::string text = optimizer.is_array()
                         ? fmt::format("{} of {}", term.value("of", "best"), optimizer.size())
                         : shown_spec(optimizer.get<std::string>());
  if (term.contains("column")) text += " " + column_words(term["column"]);
  if (term.contains("iteration")) text += " " + iteration_text(term, "");
  if (term.contains("at")) text += fmt::format(" at {}", figure(real_of(term["at"])));
  return text;
}

}  // namespace

Real published_value(const Json& published) {
  for (const char* key : {"value", "at_least", "at_most"})
    if (published.contains(key)) return real_of(published[key]);
  return 0;  // a table: no distance from it
}

std::string published_text(const Json& claim) {
  const Json& published = claim.at("published");
  const std::string error = tolerance_text(claim.at("tolerance"));
  if (published.contains("table"))
    return published["table"].size() == 1
               ? fmt::format("an end point ({})", error)
               : fmt::format("{} rows of figures ({})", published["table"].size(), error);
  const char* relation = published.contains("at_least")  ? "≥ "
                         : published.contains("at_most") ? "≤ "
                                                         : "";
  return fmt::format("{}{} ({})", relation, figure(published_value(published)), error);
}

std::string source_text(const Json& source) {
  std::string text = source.at("paper");
  for (const char* part : {"section", "figure"})
    if (source.contains(part)) text += fmt::format(", {}", source[part].get<std::string>());
  return text;
}

std::string quantity_text(const Json& claim) {
  const Json& quantity = claim.at("quantity");
  const std::string kind = quantity.at("kind");
  std::vector<std::string> terms;
  for (const Json& term : quantity.at("terms")) {
    terms.push_back(term_text(term));
  }
  return fmt::format("{} of the {}, {}: {}", kind, column_words(quantity.at("column")),
                     iteration_text(quantity, quantity.contains("clock") ? "at equal processor time"
                                                                         : "at the end"),
                     joined(terms, kind == "ratio" ? " / " : ", "));
}

}  // namespace isoline::reports
