// Ends of profile-likelihood intervals, by fits of the other unknowns at values of one, and their
// file.
#include "core/results/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/records/fields.h"
#include "core/results/statistics.h"

namespace isoline::results {
namespace {

constexpr Real kNowhere = std::numeric_limits<Real>::infinity();
constexpr Real kExact = 0.005;  // of t

struct Tried {
  Real distance, u;  // u = √((S − S_min)/s²)
  std::vector<Real> x;
};

// One side of the profile of one unknown, over z: the unknown or its logarithm.
class Side {
 public:
  Side(const ProfiledFit& fit, std::size_t unknown, int sign, LikelihoodProfile& out)
      : fit_(fit), unknown_(unknown), sign_(sign), out_(out) {
    t_ = student_quantile(0.975, fit.freedom);
    const Real x = fit.best.x[unknown];
    const Real deviation = fit.deviation[unknown] / (fit.is_log[unknown] ? x : 1);
    reach_ = std::isfinite(deviation) && deviation > 0 ? t_ * deviation
             : x != 0                                  ? 0.1 * std::abs(z_of(x))
                                                       : 1;
    const Real bound = sign > 0 ? fit.upper[unknown] : fit.lower[unknown];
    room_ = std::isfinite(bound) ? std::abs(z_of(bound) - z_of(x)) : kNowhere;
    tried_ = {{0, 0, fit.best.x}};
  }

  Real end(const RefitAt& refit) {
    Real distance = reach_ < room_ ? reach_ : room_ / 2;
    for (std::size_t i = 0; i < kProfilePoints && room_ > 0; ++i) {
      if (is_at_end(add(distance, refit)) || is_beaten_) break;
      const std::optional<Real> next = is_hard_ ? nearer_than(distance) : next_distance();
      if (!next || std::ranges::find(tried_, *next, &Tried::distance) != tried_.end()) break;
      distance = *next;
    }
    return concluded();
  }

 private:
  Real z_of(Real x) const { return fit_.is_log[unknown_] ? std::log(x) : x; }
  Real value_at(Real distance) const {
    const Real z = z_of(fit_.best.x[unknown_]) + sign_ * distance;
    return fit_.is_log[unknown_] ? std::exp(z) : z;
  }

  // On the line through the two fits nearby, inside the bounds.
  std::vector<Real> along(std::vector<Tried>::const_iterator nearest, Real distance) const {
    std::vector<Real> x = nearest->x;
    if (tried_.size() < 2) return x;
    const auto other = nearest == tried_.begin() ? nearest + 1 : nearest - 1;
    const Real share = (distance - nearest->distance) / (nearest->distance - other->distance);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Real moved = fit_.is_log[i] ? x[i] * std::pow(x[i] / other->x[i], share)
                                        : x[i] + share * (x[i] - other->x[i]);
      if (moved >= fit_.lower[i] && moved <= fit_.upper[i]) x[i] = moved;
    }
    return x;
  }
  const Tried* add(Real distance, const RefitAt& refit) {
    const auto nearest = std::ranges::min_element(
        tried_, {}, [&](const Tried& each) { return std::abs(each.distance - distance); });
    std::vector<Real> start = along(nearest, distance);
    const Real value = start[unknown_] = value_at(distance);
    const std::optional<Refit> found = refit(unknown_, start);
    is_hard_ = found && std::isnan(found->sum_of_squares);
    if (is_hard_) return nullptr;
    if (!found || !std::isfinite(found->sum_of_squares)) {
      failed_ = std::min(failed_, distance);
      out_.messages.push_back(fmt::format("P has no value at {} = {:.6g}", out_.name, value));
      return nullptr;
    }
    const Real rise = (found->sum_of_squares - fit_.best.sum_of_squares) / fit_.variance;
    constexpr Real kBetter = -0.01;  // less changes t by 0.1 %
    if (rise < kBetter) {
      is_beaten_ = true;
      out_.messages.push_back(
          fmt::format("at {} = {:.6g} the fit is better than the one that is profiled: fit again "
                      "from there",
                      out_.name, value));
    }
    out_.value.push_back(value);
    out_.rise.push_back(rise);
    const auto at = std::ranges::lower_bound(tried_, distance, {}, &Tried::distance);
    return &*tried_.insert(at, {distance, std::sqrt(std::max<Real>(rise, 0)), found->x});
  }
  bool is_at_end(const Tried* last) const {
    return last != nullptr &&
           (std::abs(last->u - t_) <= kExact * t_ || (last->distance == room_ && last->u < t_));
  }

  // The last value with u ≤ t, and the next one, if there is one.
  std::pair<const Tried*, const Tried*> around_end() const {
    const auto last = std::ranges::find_if(tried_.rbegin(), tried_.rend(),
                                           [&](const Tried& each) { return each.u <= t_; });
    return {&*last, last == tried_.rbegin() ? nullptr : &*last + 1};
  }
  // Where u = t: by u's inverse parabola or line through the nearest points; between points far
  // from t with a margin, a share of what is between them.
  Real crossing(Real margin) const {
    std::vector<Tried> near = tried_;
    std::ranges::sort(near, {}, [&](const Tried& each) { return std::abs(each.u - t_); });
    const auto [below, above] = around_end();
    const Real low = below->distance, high = above != nullptr ? above->distance : kNowhere;
    constexpr Real kFar = 0.2;
    const bool is_far = above != nullptr && std::abs(near[0].u - t_) > kFar * t_;
    margin *= is_far ? high - low : 0;
    for (const std::size_t count : {3U, 2U}) {
      if (near.size() < count) continue;
      Real distance = 0;  // Lagrange's formula
      for (std::size_t i = 0; i < count; ++i) {
        Real share = near[i].distance;
        for (std::size_t j = 0; j < count; ++j)
          if (j != i) share *= (t_ - near[j].u) / (near[i].u - near[j].u);
        distance += share;
      }
      if (low <= distance && distance <= high)
        return std::clamp(distance, low + margin, high - margin);
    }
    constexpr Real kLonger = 2.5;
    return above != nullptr ? (low + high) / 2 : kLonger * low;
  }
  // Where the others may converge, with a fit nearer by.
  std::optional<Real> nearer_than(Real distance) const {
    constexpr Real kNear = 0.01;
    Real below = 0;
    for (const Tried& each : tried_)
      if (each.distance < distance) below = each.distance;
    if (distance - below <= kNear * distance) return std::nullopt;
    return (below + distance) / 2;
  }
  std::optional<Real> next_distance() const {
    constexpr Real kMargin = 0.1, kNear = 0.02, kFlat = 100, kJump = 1e-3;
    const Tried& last = tried_.back();
    if (const auto [below, above] = around_end(); above != nullptr) {
      if (above->distance - below->distance <= kJump * above->distance) return std::nullopt;
      return crossing(kMargin);
    }
    if (failed_ < kNowhere) {
      if (failed_ - last.distance <= kNear * failed_) return std::nullopt;
      return (last.distance + failed_) / 2;
    }
    if (last.distance > kFlat * reach_) return std::nullopt;
    if (last.distance == 0) return std::min(reach_ / 2, room_);
    const Real most = (last.u > 0.8 * t_ ? 1.3 : 2.5) * last.distance;  // of what is not known
    return std::min({crossing(0), most, room_});
  }

  // Another unknown that a bound holds there, and not at the fit.
  std::string held_at(const std::vector<Real>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto is_at_bound = [&](Real at) { return at <= fit_.lower[i] || at >= fit_.upper[i]; };
      if (i != unknown_ && is_at_bound(x[i]) && !is_at_bound(fit_.best.x[i])) return fit_.names[i];
    }
    return "";
  }
  Real concluded() const {
    if (is_beaten_) return std::numeric_limits<Real>::quiet_NaN();
    const char* const side = sign_ > 0 ? "upper" : "lower";
    const Tried& last = tried_.back();
    const Tried& nearest = *std::ranges::min_element(
        tried_, {}, [&](const Tried& each) { return std::abs(each.u - t_); });
    const Real miss = std::abs(nearest.u - t_);
    const auto [below, above] = around_end();
    if (above != nullptr || miss <= kExact * t_) {
      constexpr Real kInexact = 0.02;  // of t
      if (const std::string held = held_at(nearest.x); !held.empty())
        out_.messages.push_back(
            fmt::format("the {} limit of {} holds with {} at a bound; without it, it lies beyond",
                        side, out_.name, held));
      if (miss > kInexact * t_)
        out_.messages.push_back(fmt::format(
            "the {} limit of {} is inexact: between {:.6g} and {:.6g}, the root of (S − S_min)/s² "
            "rises from {:.3g} to {:.3g}, past t = {:.3g}",
            side, out_.name, value_at(below->distance), value_at(above->distance), below->u,
            above->u, t_));
      return value_at(std::min(crossing(0), room_));
    }
    const Real value = value_at(last.distance);
    if (last.distance >= room_) {
      out_.messages.push_back(fmt::format(
          "{} has no {} limit within its bounds: the interval is one-sided", out_.name, side));
      return value;
    }
    if (failed_ < kNowhere) {
      out_.messages.push_back(fmt::format(
          "the {} limit of {} lies where evaluations fail; {:.6g} is the last value before", side,
          out_.name, value));
      return value;
    }
    if (is_hard_) {
      out_.messages.push_back(
          fmt::format("the {} limit of {} was not found: fits of the others beyond {:.6g} do not "
                      "converge",
                      side, out_.name, value));
      return std::numeric_limits<Real>::quiet_NaN();
    }
    out_.messages.push_back(fmt::format("{} is not identifiable {} {:.6g}: the profile is flat",
                                        out_.name, sign_ > 0 ? "above" : "below", value));
    return sign_ * kNowhere;
  }

  const ProfiledFit& fit_;
  std::size_t unknown_;
  int sign_;
  LikelihoodProfile& out_;
  Real t_ = 0, reach_ = 0, room_ = 0, failed_ = kNowhere;
  bool is_beaten_ = false;    // by a better fit
  bool is_hard_ = false;      // the last fit of the others did not converge
  std::vector<Tried> tried_;  // ascending distances
};

}  // namespace

LikelihoodProfile profile_of(const ProfiledFit& fit, std::size_t unknown, const RefitAt& refit) {
  LikelihoodProfile out{.name = fit.names[unknown]};
  out.low = Side(fit, unknown, -1, out).end(refit);
  out.high = Side(fit, unknown, 1, out).end(refit);
  std::vector<std::pair<Real, Real>> points;
  for (std::size_t i = 0; i < out.value.size(); ++i) points.emplace_back(out.value[i], out.rise[i]);
  points.emplace_back(fit.best.x[unknown], 0);
  std::ranges::sort(points);
  out.value.clear();
  out.rise.clear();
  for (const auto& [value, rise] : points) {
    out.value.push_back(value);
    out.rise.push_back(rise);
  }
  return out;
}

// The file.

void fields(Like<LikelihoodProfile> auto& profile, auto& field) {
  field("unknown", profile.name);
  field("low", profile.low);
  field("high", profile.high);
  field("value", profile.value);
  field("rise", profile.rise);
  field("messages", profile.messages);
}

void fields(Like<ProfiledCell> auto& cell, auto& field) {
  field("cell", cell.cell, R"({"pattern": "^[0-9a-f]{16}$"})");
  field("profiles", cell.profiles);
}

namespace {

struct ProfileFile {
  std::vector<ProfiledCell> cells;
};

void fields(Like<ProfileFile> auto& file, auto& field) {
  field.constant("schema", "isoline.profile/1");
  field("cells", file.cells);
}

}  // namespace

Json to_json(const LikelihoodProfile& profile) { return json_of(profile); }

Json profiles_to_json(const std::vector<ProfiledCell>& all) { return json_of(ProfileFile{all}); }

std::vector<ProfiledCell> profiles_from_text(const std::string& text, const std::string& origin) {
  std::vector<ProfiledCell> cells =
      from_text<ProfileFile>(text, origin, "not a file of profiles (isoline.profile/1)").cells;
  for (const ProfiledCell& cell : cells)
    for (const LikelihoodProfile& profile : cell.profiles)
      require(profile.value.size() == profile.rise.size() && std::ranges::is_sorted(profile.value),
              [&] { return origin + ": the values of a profile must ascend, with a rise each"; });
  return cells;
}

Json profile_schema() {
  return schema_of<ProfileFile>("isoline.profile/1: profile-likelihood intervals of fits");
}

}  // namespace isoline::results
