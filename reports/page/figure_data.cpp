// The papers' figures in the page: captions as HTML, lines and pictures as data for the scripts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/json.h"
#include "reports/formats/escape.h"
#include "reports/page/page.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

Json numbers(const std::vector<Real>& values) {
  Json list = Json::array();
  constexpr int kDigits = 5;
  for (const Real value : values)
    list.push_back(std::isfinite(value) ? Json(std::stod(fmt::format("{:.{}g}", value, kDigits)))
                                        : Json());
  return list;
}

// Greys from 0 at `low` to 255 at `high`, two hexadecimal digits a cell.
std::string greys(const std::vector<Real>& values, Real low, Real high) {
  std::string text;
  for (const Real value : values) {
    const Real share = high > low ? (value - low) / (high - low) : 0;
    text += fmt::format("{:02x}", std::lround(255 * std::clamp(share, 0.0, 1.0)));
  }
  return text;
}

// y* has its own scale; all that are x share that of x*, which comes last.
Json pictures_json(const std::vector<Picture>& pictures) {
  Json list = Json::array();
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto [low, high] = std::ranges::minmax((i == 0 ? pictures[0] : pictures.back()).values);
    list.push_back({{"title", pictures[i].title},
                    {"size", pictures[i].size},
                    {"low", numbers({low})[0]},
                    {"high", numbers({high})[0]},
                    {"greys", greys(pictures[i].values, low, high)}});
  }
  return list;
}

Json lines_json(const std::vector<FigureLine>& lines) {
  Json list = Json::array();
  for (const FigureLine& line : lines)
    list.push_back({{"s", line.optimizer},
                    {"x", numbers(line.x)},
                    {"y", numbers(line.y)},
                    {"low", numbers(line.low)},
                    {"high", numbers(line.high)}});
  return list;
}

Json published_json(const std::vector<PublishedMark>& marks) {
  Json list = Json::array();
  for (const PublishedMark& mark : marks)
    list.push_back({{"s", mark.optimizer},
                    {"name", mark.name},
                    {"x", mark.x},
                    {"y", mark.y},
                    {"low", numbers({mark.low})[0]},
                    {"high", numbers({mark.high})[0]}});
  return list;
}

std::string problem_attribute(const Comparison& c, const Figure& figure) {
  const auto at = std::ranges::find_if(c.problems, [&](const ProblemAxis& problem) {
    return shown_spec(problem.spec) == shown_spec(figure.problem);
  });
  return at == c.problems.end() ? "" : fmt::format(" data-p={}", at - c.problems.begin());
}

}  // namespace

std::string figures_html(const Document& document) {
  const Comparison& c = document.comparison;
  const std::vector<Figure>& all = document.figures;
  std::string html;
  for (std::size_t i = 0; i < all.size(); ++i)
    html += fmt::format(
        "<figure class=\"panel{}\" data-figure={}{}><figcaption><b>{}</b> <span "
        "class=formula>{}</span>"
        "<p class=reading>{}</p></figcaption></figure>\n",
        all[i].pictures.empty() ? "" : " wide", i, problem_attribute(c, all[i]),
        html_text(all[i].title), html_text(all[i].problem), html_text(all[i].reading));
  return html.empty() ? "<p class=lead>No problem of this report has figures of its own.</p>"
                      : "<div class=panels>" + html + "</div>";
}

std::string json_quoted(const std::string& text) { return json_text(Json(text)); }

std::string figures_json(const std::vector<Figure>& all) {
  Json list = Json::array();
  for (const Figure& figure : all)
    list.push_back({{"title", figure.title},
                    {"kind", figure.kind},
                    {"x_label", figure.x_label},
                    {"y_label", figure.y_label},
                    {"log_x", figure.is_log_x},
                    {"log_y", figure.is_log_y},
                    {"diagonal", figure.has_diagonal},
                    {"published", published_json(figure.published)},
                    {"paper", figure.of_the_paper},
                    {"lines", lines_json(figure.lines)},
                    {"pictures", pictures_json(figure.pictures)}});
  return json_text(list);
}

}  // namespace isoline::reports
