// Reads rows of tables of rates.
#include "reports/read/tuned_rates.h"

#include <algorithm>
#include <filesystem>

#include "core/errors.h"
#include "core/files.h"
#include "core/records/json_view.h"
#include "reports/statistics/statistics.h"

namespace isoline::reports {
namespace {

std::string text_at(const JsonView& row, const char* key) {
  return row.contains(key) ? row.at(key).get<std::string>() : "";
}

void read_grid(const JsonView& source, TunedRate& rate) {
  const auto options = source.at("grid").items();
  if (options.empty()) return;
  rate.option = options.front().first;
  rate.values = reals_of(options.front().second);
  if (source.contains("score"))
    for (const JsonView& score : source.at("score").values())
      rate.work.push_back(real_of(score.values().at(0)));
  require(rate.work.empty() || rate.work.size() == rate.values.size(),
          "a grid of rates lacks the score of a value");
}

TunedRate rate_from(const JsonView& row) {
  TunedRate rate{.problem = row.at("problem"),
                 .optimizer = row.at("optimizer"),
                 .file = text_at(row, "file"),
                 .paper = {},
                 .option = {},
                 .values = {},
                 .work = {}};
  const JsonView source = row.at("source");
  rate.paper = text_at(source, "paper");
  if (source.contains("grid")) read_grid(source, rate);
  if (source.contains("edge")) source.at("edge").get_to(rate.is_at_edge);
  return rate;
}

}  // namespace

bool TunedRate::is_ever_solved() const {
  return std::ranges::any_of(work, [](Real each) { return each < kNever; });
}

std::vector<TunedRate> rates_from_text(const std::string& text, const std::string& origin) {
  JsonReader reader;
  std::vector<TunedRate> rates;
  for (const JsonView& row : reader.parse(text, origin).at("rows").values())
    rates.push_back(rate_from(row));
  return rates;
}

std::vector<TunedRate> read_rates(const std::string& folder) {
  const std::filesystem::path file = std::filesystem::path(folder) / "rates.json";
  if (!is_there(file)) return {};
  return rates_from_text(read_text(file), file.string());
}

}  // namespace isoline::reports
