// What the papers say, as marks in their own figures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/sections/figures.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

// Of the first line of that method; nothing where the figure has none.
std::optional<std::size_t> optimizer_of(const Comparison& c, const Figure& figure,
                                        const std::string& method) {
  for (const FigureLine& line : figure.lines)
    if (c.optimizers[line.optimizer].method == method) return line.optimizer;
  return std::nullopt;
}

// Where a term of a claim stands across a figure; nothing where it is of another problem.
std::optional<Real> place_in(const Figure& figure, const EvidenceTerm& term) {
  const std::string problem = shown_spec(term.problem);
  const bool is_relative = std::abs(term.scale - 1) > 1e-9;
  if (figure.kind == "sweep" && is_relative == figure.is_relative)
    for (const auto& [name, x] : figure.places)
      if (name == problem) return x;
  if (figure.kind != "curve" || figure.problem != problem || is_relative) return std::nullopt;
  return term.read_at;
}

void add_mark(Figure& figure, const Comparison& c, const Judgement& claim) {
  const Evidence& evidence = claim.evidence;
  const bool is_level = evidence.kind == "value" && evidence.terms.size() == 1 && claim.band &&
                        evidence.column.find("x_error") != std::string::npos;
  if (!is_level) return;
  const EvidenceTerm& term = evidence.terms[0];
  const auto x = place_in(figure, term);
  const auto optimizer = optimizer_of(c, figure, term.method);
  if (x && optimizer)
    figure.published.push_back(
        {.optimizer = *optimizer,
         .name = fmt::format("{}, published: {}", term.method, column_words(evidence.column)),
         .x = *x,
         .y = evidence.published,
         .low = claim.band->low,
         .high = claim.band->high});
}

void add_methods(Figure& figure, const Comparison& c, const Judgement& claim) {
  for (const EvidenceTerm& term : claim.evidence.terms)
    if (place_in(figure, term) || shown_spec(term.problem) == figure.problem)
      for (const FigureLine& line : figure.lines)
        if (c.optimizers[line.optimizer].method == term.method)
          figure.of_the_paper.insert(line.optimizer);
}

}  // namespace

void add_published(std::vector<Figure>& all, const Comparison& c,
                   const std::vector<Judgement>& claims) {
  for (Figure& figure : all)
    for (const Judgement& claim : claims) {
      add_mark(figure, c, claim);
      add_methods(figure, c, claim);
    }
}

}  // namespace isoline::reports
