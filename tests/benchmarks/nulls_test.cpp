// What no claim may survive, for then no data could turn it: optimizers under each other's names,
// networks that were never trained, one method under all names.
#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <ranges>

#include "benchmarks/plan/claim_cells.h"
#include "core/random.h"
#include "reports/report.h"
#include "reports/sections/claim_terms.h"
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

// The claims of the tree, as if they spoke of no more than so many iterations: of each the
// cheapest of its sets of cells, over so many seeds where it is over any.
std::vector<Claim> shortened(std::int64_t most, int seeds) {
  std::vector<Claim> all;
  for (const auto& [name, text] : builtin_claims()) {
    Json file = parse_json(std::string(text), name);
    for (Json& claim : file["claims"]) {
      if (claim.contains("not_comparable"))  // no run decides it
        for (const char* part : {"cells", "quantity", "contrast"}) claim.erase(part);
      if (!claim.contains("cells")) continue;
      Json cheapest = claim["cells"].back();
      Json& iterations = cheapest["budget"]["iterations"];
      iterations = std::min(most, iterations.get<std::int64_t>());
      if (cheapest.contains("seeds")) cheapest["seeds"] = std::to_string(seeds);
      claim["cells"] = Json::array({cheapest});
      claim.erase("length");
      shorten(claim, most);
      if (claim.contains("contrast")) shorten(claim["contrast"], most);
    }
    for (Claim& claim : claims_from_json(catalog(), Rates::builtin(), file, name))
      if (!claim.cells.empty()) all.push_back(std::move(claim));
  }
  return all;
}

// Whether a cell of a claim is of one of these kinds, by what its specs say.
bool has(const Claim& claim, const std::vector<std::string>& parts) {
  return std::ranges::any_of(claim.cells.back().requests, [&](const Request& request) {
    const std::string spec = request.problem.spec + " " + request.optimizer.spec;
    return std::ranges::any_of(
        parts, [&](const std::string& part) { return spec.find(part) != std::string::npos; });
  });
}

// Those whose cells take seconds.
std::vector<Claim> quick_claims(std::int64_t most, int seeds) {
  std::vector<Claim> all = shortened(most, seeds);
  std::erase_if(all, [](const Claim& claim) {
    return has(claim,
               {"heat", "poisson", "phi", "watch", "steps", "theorem", "batch", "xi=48", "xi=64"});
  });
  return all;
}

bool is_good(const Judgement& judgement) { return judgement.verdict <= Verdict::consistent; }

// At most one in twenty of those that were judged.
void expect_hardly_any(const std::vector<Judgement>& judgements) {
  std::string survivors;
  const auto judged = std::ranges::count_if(judgements, [](const Judgement& judgement) {
    return reports::is_decided(judgement.verdict);
  });
  for (const Judgement& judgement : judgements)
    if (is_good(judgement)) survivors += judgement.id + " " + measured_text(judgement) + "\n";
  EXPECT_GT(judged, 20);
  EXPECT_LE(20 * std::ranges::count_if(judgements, is_good), judged) << survivors;
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
  const std::vector<Claim> claims = quick_claims(1, 1);
  std::vector<Record> runs = FinishedMatrix(catalog(), cells_of(claims, true)).records;
  for (Record& run : runs) run = untrained(std::move(run));
  expect_hardly_any(judge(json_of(claims), runs));
}

// --- runs that take seconds, far shorter than the claims speak of

struct Trained {
  std::vector<Claim> claims = quick_claims(200, 3);
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

// --- one method under all its names

TEST(Nulls, AtMostOneClaimInTwentyOutlivesOneMethodUnderAllNames) {
  std::vector<Record> runs = trained().runs;
  std::map<std::pair<std::string, std::uint64_t>, const Record*> first;
  for (Record& run : runs) {
    const auto known = first.emplace(std::pair{run.request.problem.spec, run.request.seed}, &run);
    if (known.second) continue;
    const std::string cell = run.cell;
    run = *known.first->second;
    run.cell = cell;
  }
  expect_hardly_any(judge(json_of(claims_of_rivals()), runs));
}

// --- labels permuted

// What was asked of one problem: an optimizer with its options, rates and budget, over seeds.
struct Label {
  std::string optimizer;
  std::map<std::uint64_t, std::size_t> runs;  // by seed
};

// By problem.
std::map<std::string, std::vector<Label>> labels_of(const std::vector<Record>& runs) {
  std::map<std::string, std::map<std::string, Label>> problems;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Request& asked = runs[i].request;
    const std::string text =
        asked.optimizer.spec + asked.rates + std::to_string(asked.budget.iterations);
    Label& label = problems[asked.problem.spec][text];
    label.optimizer = asked.optimizer.name;
    label.runs[asked.seed] = i;
  }
  std::map<std::string, std::vector<Label>> lists;
  for (const auto& [problem, labels] : problems)
    for (const auto& [text, label] : labels) lists[problem].push_back(label);
  return lists;
}

// Whether each can go by the name of another: none has more than half of the labels.
bool has_rivals(const std::vector<Label>& labels) {
  std::map<std::string, std::size_t> count;
  for (const Label& label : labels) ++count[label.optimizer];
  return std::ranges::all_of(count,
                             [&](const auto& own) { return 2 * own.second <= labels.size(); });
}

// Every label goes to another one, of another optimizer.
std::vector<std::size_t> derangement(const std::vector<Label>& labels, RandomStream& random) {
  std::vector<std::size_t> to(labels.size());
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = i;
  const auto stays = [&](std::size_t i) { return labels[i].optimizer == labels[to[i]].optimizer; };
  do
    for (std::size_t i = to.size(); i-- > 1;)
      std::swap(to[i], to[static_cast<std::size_t>(random.uniform() * static_cast<Real>(i + 1))]);
  while (std::ranges::any_of(std::views::iota(std::size_t{0}, to.size()), stays));
  return to;
}

// The runs of each problem answer to the labels of others, all seeds of a label to the same one.
std::vector<Record> relabelled(const std::vector<Record>& runs, RandomStream& random) {
  std::vector<Record> turned = runs;
  for (const auto& [problem, labels] : labels_of(runs)) {
    if (!has_rivals(labels)) continue;
    const std::vector<std::size_t> to = derangement(labels, random);
    for (std::size_t i = 0; i < labels.size(); ++i)
      for (const auto& [seed, run] : labels[i].runs) {
        const auto& others = labels[to[i]].runs;  // of fewer seeds, perhaps
        const auto same = others.find(seed);
        turned[run] = runs[(same == others.end() ? others.begin() : same)->second];
        turned[run].cell = runs[run].cell;
      }
  }
  return turned;
}

// How often each claim comes out well, of so many permutations.
std::map<std::string, Real> survivals(const std::vector<Claim>& claims,
                                      const std::vector<Record>& runs) {
  constexpr int kPermutations = 50;
  const Json asked = json_of(claims);
  std::map<std::string, Real> shares;
  for (const Judgement& judgement : judge(asked, runs))
    if (reports::is_decided(judgement.verdict)) shares[judgement.id] = 0;
  RandomStream random(0, "claims", "labels");
  for (int i = 0; i < kPermutations; ++i)
    for (const Judgement& judgement : judge(asked, relabelled(runs, random)))
      if (judgement.verdict == Verdict::reproduced) shares[judgement.id] += 1.0 / kPermutations;
  return shares;
}

// On the whole, and no single one by hiding among the others.
TEST(Nulls, AtMostOneClaimInTwentyOutlivesPermutedLabels) {
  const auto shares = survivals(claims_of_rivals(), trained().runs);
  Real sum = 0;
  std::string list;
  int often = 0;
  for (const auto& [claim, share] : shares) {
    sum += share;
    often += share > 0.5;
    list += claim + " " + std::to_string(share) + "\n";
  }
  ASSERT_GT(shares.size(), 20U);
  EXPECT_LE(20 * sum, static_cast<Real>(shares.size())) << list;
  EXPECT_LE(20 * often, std::ssize(shares)) << list;
}

}  // namespace
}  // namespace isoline::benchmarks
