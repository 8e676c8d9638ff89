// What no claim may survive, for then no data could turn it: optimizers under each other's names,
// networks that were never trained, one method under all names.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numeric>
#include <ranges>

#include "benchmarks/plan/claim_cells.h"
#include "core/random.h"
#include "reports/report.h"
#include "reports/sections/claims.h"
#include "tests/benchmarks/builtin.h"
#include "tests/benchmarks/matrix.h"

namespace isoline::benchmarks {

using reports::judge;
using reports::Judgement;
using reports::Verdict;
namespace {

void shorten(Json& asked, std::int64_t most) {
  Json& quantity = asked["quantity"];
  const auto cut = [&](Json& place) {
    if (place.contains("iteration"))
      place["iteration"] = std::min(most, place["iteration"].get<std::int64_t>());
  };
  cut(quantity);
  for (Json& term : quantity["terms"]) cut(term);
}

// The claims of the tree as if they spoke of no more than so many iterations: of each the cheapest
// of its sets of cells, over so many seeds where it is over any. Left out are those in whose cells
// one of the dear words stands: there a step takes seconds, or its measurements do.
std::vector<Claim> claims_without(const std::vector<std::string>& dear, std::int64_t most,
                                  int seeds) {
  const auto is_dear = [&](const Request& request) {
    const std::string spec = request.problem.spec + " " + request.optimizer.spec;
    return std::ranges::any_of(
        dear, [&](const std::string& part) { return spec.find(part) != std::string::npos; });
  };
  std::vector<Claim> all;
  for (const auto& [name, text] : builtin_claims()) {
    Json file = parse_json(std::string(text), name);
    for (Json& claim : file["claims"]) {
      if (claim.contains("not_comparable") || claim.contains("undecidable"))  // no run decides it
        for (const char* part : {"cells", "quantity", "contrasts"}) claim.erase(part);
      if (!claim.contains("cells")) continue;
      Json cheapest = claim["cells"].back();
      Json& iterations = cheapest["budget"]["iterations"];
      iterations = std::min(most, iterations.get<std::int64_t>());
      if (cheapest.contains("seeds")) cheapest["seeds"] = std::to_string(seeds);
      claim["cells"] = Json::array({cheapest});
      claim.erase("length");
      shorten(claim, most);
      if (claim.contains("contrasts"))
        for (Json& contrast : claim["contrasts"]) shorten(contrast, most);
    }
    for (Claim& claim : claims_from_json(catalog(), Rates::builtin(), file, name))
      if (!claim.cells.empty() && std::ranges::none_of(claim.cells.back().requests, is_dear))
        all.push_back(std::move(claim));
  }
  return all;
}

// How often each claim comes out well, of so many times that a falsehood is planted.
struct Survival {
  Real reproduced = 0, consistent = 0;  // shares, the second with the first
};

// At most one in twenty survives on the whole, and no single one by hiding among the others.
void expect_rare(const std::vector<Claim>& claims, const std::vector<Record>& runs, int times,
                 const std::function<std::vector<Record>(int)>& planted, Real Survival::*kind) {
  const Json asked = json_of(claims);
  std::map<std::string, Survival> shares;
  for (const Judgement& judgement : judge(asked, runs))
    if (reports::is_decided(judgement.verdict)) shares[judgement.id] = {};
  for (int i = 0; i < times; ++i)
    for (const Judgement& judgement : judge(asked, planted(i))) {
      Survival& share = shares[judgement.id];
      share.reproduced += judgement.verdict <= Verdict::reproduced ? 1.0 / times : 0;
      share.consistent += reports::is_supported(judgement.verdict) ? 1.0 / times : 0;
    }
  Real sum = 0;
  std::string list;
  for (const auto& [claim, share] : shares) {
    sum += share.*kind;
    if (share.consistent > 0)
      list += fmt::format("{} {:.2f} {:.2f}\n", claim, share.reproduced, share.consistent);
    EXPECT_LE(share.consistent, 0.5) << claim;
  }
  EXPECT_GT(shares.size(), 35U);
  EXPECT_LE(20 * sum, static_cast<Real>(shares.size())) << list;
}

// --- networks that were never trained, and steps that were never taken

// Every figure is that of iteration 0, or of the first step where it begins with that.
Record untrained(Record record) {
  const auto keep = [](auto& column) {
    if (column.empty()) return;
    std::size_t first = 0;
    if constexpr (std::is_same_v<std::decay_t<decltype(column[0])>, Real>)
      first = std::isnan(column[0]) && column.size() > 1 ? 1 : 0;
    const auto value = column[first];
    std::ranges::fill(column, value);
  };
  Curve& curve = record.curve;
  for (auto* column : {&curve.loss, &curve.x_error, &curve.gradient_norm, &curve.step_norm})
    keep(*column);
  for (auto* windows : {&curve.batch_loss, &curve.batch_x_error})
    for (auto& [window, column] : *windows) keep(column);
  for (auto& [name, column] : record.series) keep(column);
  if (record.trajectory) {
    keep(record.trajectory->x);
    keep(record.trajectory->y);
  }
  return record;
}

TEST(Nulls, AtMostOneClaimInTwentyOutlivesNetworksThatWereNeverTrained) {
  // That the adjoint removes detail holds for the physics, with networks that were trained or not.
  const std::vector<Claim> claims = claims_without({"hessian-free", "watch=spectrum"}, 1, 1);
  const std::vector<Record> runs = FinishedMatrix(catalog(), cells_of(claims, true)).records;
  const auto planted = [&](int) {
    std::vector<Record> all;
    for (const Record& run : runs) all.push_back(untrained(run));
    return all;
  };
  expect_rare(claims, runs, 1, planted, &Survival::consistent);
}

// --- runs that take seconds, far shorter than the claims speak of

struct Trained {
  std::vector<Claim> claims =
      claims_without({"heat", "poisson", "navier", "watch", "steps", "theorem", "batch"}, 1000, 6);
  std::vector<Record> runs = FinishedMatrix(catalog(), cells_of(claims, true)).records;
};

const Trained& trained() {
  static const Trained all;
  return all;
}

// Those that name several optimizers of a problem: no other can take one for another.
std::vector<Claim> claims_of_rivals() {
  std::vector<Claim> all = trained().claims;
  std::erase_if(all, [](const Claim& claim) { return !reports::has_rivals(*claim.json); });
  return all;
}

// --- labels permuted

// What was asked of one problem: an optimizer with its options, rates and budget, over seeds.
using BySeed = std::map<std::uint64_t, std::size_t>;
struct Label {
  std::string optimizer;
  BySeed runs;
};

// Another label may have fewer seeds.
std::size_t of_seed(const BySeed& runs, std::uint64_t seed) {
  const auto same = runs.find(seed);
  return (same == runs.end() ? runs.begin() : same)->second;
}

// By problem and length: what ran ten times as long is nobody's equal.
std::map<std::string, std::vector<Label>> labels_of(const std::vector<Record>& runs) {
  std::map<std::string, std::map<std::string, Label>> problems;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Request& asked = runs[i].request;
    const std::string length = std::to_string(asked.budget.iterations);
    Label& label = problems[asked.problem.spec + length][asked.optimizer.spec + asked.rates];
    label.optimizer = asked.optimizer.name;
    label.runs[asked.seed] = i;
  }
  std::map<std::string, std::vector<Label>> lists;
  for (const auto& [problem, labels] : problems)
    for (const auto& [text, label] : labels) lists[problem].push_back(label);
  return lists;
}

// Whether no optimizer has more than half of the labels: then each can go to one of its own.
bool are_mixed(const std::vector<Label>& labels) {
  std::map<std::string, std::size_t> count;
  for (const Label& label : labels) ++count[label.optimizer];
  return std::ranges::all_of(count,
                             [&](const auto& own) { return 2 * own.second <= labels.size(); });
}

// Every label goes to one of another optimizer, no two to the same where they are mixed.
std::vector<std::size_t> derangement(const std::vector<Label>& labels, RandomStream& random) {
  const auto any = [&](std::size_t count) {
    return static_cast<std::size_t>(random.uniform() * static_cast<Real>(count));
  };
  std::vector<std::size_t> to(labels.size());
  std::iota(to.begin(), to.end(), 0);
  const auto stays = [&](std::size_t i) { return labels[i].optimizer == labels[to[i]].optimizer; };
  if (!are_mixed(labels))
    for (std::size_t i = 0; i < to.size(); ++i)
      while (stays(i)) to[i] = any(to.size());
  while (std::ranges::any_of(std::views::iota(std::size_t{0}, to.size()), stays))
    for (std::size_t i = to.size(); i-- > 1;) std::swap(to[i], to[any(i + 1)]);
  return to;
}

// The runs of each problem answer to the labels of others, all seeds of a label to the same one.
std::vector<Record> relabelled(const std::vector<Record>& runs, RandomStream& random) {
  std::vector<Record> turned = runs;
  for (const auto& [problem, labels] : labels_of(runs)) {
    const auto is_first = [&](const Label& label) {
      return label.optimizer == labels[0].optimizer;
    };
    if (std::ranges::all_of(labels, is_first)) continue;  // there is no other
    const std::vector<std::size_t> to = derangement(labels, random);
    for (std::size_t i = 0; i < labels.size(); ++i)
      for (const auto& [seed, run] : labels[i].runs) {
        turned[run] = runs[of_seed(labels[to[i]].runs, seed)];
        turned[run].cell = runs[run].cell;
      }
  }
  return turned;
}

// Which of two is ahead comes out right by chance every other time, and a chance that does not hold
// for all seeds is still consistent: of that none has more than its half.
TEST(Nulls, AtMostOneClaimInTwentyIsReproducedByPermutedLabels) {
  constexpr int kPermutations = 50;
  RandomStream random(0, "claims", "labels");
  const std::vector<Record>& runs = trained().runs;
  const auto planted = [&](int) { return relabelled(runs, random); };
  expect_rare(claims_of_rivals(), runs, kPermutations, planted, &Survival::reproduced);
}

// --- one method under all its names

// All runs of each problem are those of its i-th label.
std::vector<Record> of_one_label(const std::vector<Record>& runs, int i) {
  std::vector<Record> planted = runs;
  for (const auto& [problem, labels] : labels_of(runs)) {
    const auto& one = labels[static_cast<std::size_t>(i) % labels.size()].runs;
    for (const Label& label : labels)
      for (const auto& [seed, run] : label.runs) {
        planted[run] = runs[of_seed(one, seed)];
        planted[run].cell = runs[run].cell;
      }
  }
  return planted;
}

TEST(Nulls, AtMostOneClaimInTwentyOutlivesOneMethodUnderAllNames) {
  constexpr int kMethods = 12;  // of a problem: the square has more names, of the same methods
  const std::vector<Record>& runs = trained().runs;
  const auto planted = [&](int i) { return of_one_label(runs, i); };
  expect_rare(claims_of_rivals(), runs, kMethods, planted, &Survival::consistent);
}

}  // namespace
}  // namespace isoline::benchmarks
