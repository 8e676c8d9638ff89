// Finds the rows of tables of rates by the records that used them.
#include "reports/sections/origins.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/spec.h"
#include "reports/sections/words.h"

namespace isoline::reports {
namespace {

const Request* request_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Cell& cell = c.cell(p, s);
  return cell.runs.empty() ? nullptr : &c.runs[cell.runs.front()].record->request;
}

// "3.8e-5" of gd[rate=3.8e-5], "rate=1, momentum=0.9" where there are several, "default" of gd.
std::string values_text(const Request& request) {
  const Spec spec = parse_spec(request.optimizer.spec);
  std::vector<std::string> shown;  // long numbers cut
  for (const auto& [name, value] : spec.options)
    shown.push_back(shown_spec(fmt::format("{}={}", name, value)));
  if (shown.empty()) return "default";
  return shown.size() > 1 ? joined(shown) : shown[0].substr(spec.options[0].first.size() + 1);
}

}  // namespace

const TunedRate* rate_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Request* request = request_of(c, p, s);
  if (request == nullptr || request->rates.empty()) return nullptr;
  const auto& rates = c.study->rates;
  const auto is_its = [&](const TunedRate& rate) {
    return rate.problem == request->problem.spec && rate.optimizer == request->optimizer.name &&
           rate.file == request->rates;
  };
  const auto at = std::ranges::find_if(rates, is_its);
  return at == rates.end() ? nullptr : &*at;
}

Origin origin_of(const Comparison& c, std::size_t p, std::size_t s) {
  const Request* request = request_of(c, p, s);
  if (request == nullptr) return Origin::defaults;
  if (request->rates.empty())
    return request->optimizer.spec == request->optimizer.name ? Origin::defaults : Origin::given;
  const TunedRate* rate = rate_of(c, p, s);
  if (rate == nullptr) return Origin::table;
  return rate->is_tuned() ? Origin::tuned : Origin::published;
}

std::string origin_text(const Comparison& c, std::size_t p, std::size_t s) {
  const Origin origin = origin_of(c, p, s);
  if (origin == Origin::defaults || origin == Origin::given) return "";
  return fmt::format("{}, {}", values_text(*request_of(c, p, s)), name_of(origin));
}

std::string setting_text(const Comparison& c, std::size_t p, std::size_t s) {
  const std::string origin = origin_text(c, p, s);
  if (origin.empty()) return shown_spec(c.optimizers[s].label);
  return fmt::format("{} ({})", c.optimizers[s].method, origin);
}

}  // namespace isoline::reports
