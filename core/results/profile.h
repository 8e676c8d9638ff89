// Profile-likelihood intervals of the unknowns of a fit.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/json.h"
#include "core/real.h"

namespace isoline::results {

// The other unknowns fitted again at a value of one of them.
struct Refit {
  Real sum_of_squares = 0;   // not-a-number where the fit of the others did not converge
  std::vector<Real> x = {};  // all unknowns
};
// `start` is the x of a fit nearby, in which that unknown has the value. Nothing where P has no
// value.
using RefitAt =
    std::function<std::optional<Refit>(std::size_t unknown, const std::vector<Real>& start)>;

struct ProfiledFit {
  std::vector<std::string> names = {};  // (k), as what follows
  Refit best = {};
  std::vector<Real> deviation = {}, lower = {}, upper = {};  // bounds may be infinite
  std::vector<bool> is_log = {};                             // profiled over the logarithm
  Real variance = 0;                                         // s²
  std::size_t freedom = 0;                                   // ν
};

struct LikelihoodProfile {
  std::string name;
  // Infinite where the profile stays flat, the bound where it ends within, and not-a-number where a
  // better fit was found.
  Real low = 0, high = 0;
  std::vector<Real> value = {},
                    rise = {};  // ascending; (S − S_min)/s² at each value that was tried
  std::vector<std::string> messages = {};  // that limit the interval
};

inline constexpr std::size_t kProfilePoints = 40;  // at most, on each side

// The values for which S ≤ S_min + t² s², t Student's for 95 % and ν degrees of freedom, as those
// of lmfit's conf_interval; √((S − S_min)/s²) is nearly linear in the value. Each end is exact to
// 0.5 % of t. Bates, Watts (1988), section 6.1.
LikelihoodProfile profile_of(const ProfiledFit& fit, std::size_t unknown, const RefitAt& refit);

// Schema isoline.profile/1, the file profile.json of a result folder: the profiles of the fits that
// were profiled, by their cells.
struct ProfiledCell {
  std::string cell;
  std::vector<LikelihoodProfile> profiles = {};
};
Json to_json(const LikelihoodProfile& profile);
Json profiles_to_json(const std::vector<ProfiledCell>& all);
std::vector<ProfiledCell> profiles_from_text(const std::string& text, const std::string& origin);
Json profile_schema();  // what benchmarks/schemas/profile.json holds

}  // namespace isoline::results
