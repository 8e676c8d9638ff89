// The size of a plan: the settings of its sweeps times each other, times its seeds.
#include "benchmarks/plan/plan_size.h"

#include <fmt/format.h>

#include <algorithm>

#include "benchmarks/plan/filter.h"
#include "core/text.h"

namespace isoline::benchmarks {
namespace {

// Components with the settings of each.
class Settings {
 public:
  void add(std::string name, std::uint64_t settings) {
    all_.push_back({std::move(name), settings});
    total_ = sum_of(total_, settings);
  }
  void add_each(const std::string& text) {
    for (SweepSize& size : sweep_sizes(text)) add(std::move(size.name), size.settings);
  }
  std::uint64_t total() const { return total_; }

  // "400 settings of sine", "17 problems", "401 settings of 2 problems, 400 of them of sine"
  std::string words(const char* kinds) const {
    const SweepSize& most = *std::ranges::max_element(all_, {}, &SweepSize::settings);
    if (all_.size() == 1) return fmt::format("{} settings of {}", count_text(total_), most.name);
    if (total_ == all_.size()) return fmt::format("{} {}", count_text(total_), kinds);
    return fmt::format("{} settings of {} {}, {} of them of {}", count_text(total_), all_.size(),
                       kinds, count_text(most.settings), most.name);
  }

 private:
  std::vector<SweepSize> all_;
  std::uint64_t total_ = 0;
};

bool is_excepted(const std::vector<std::string>& excepted, const std::string& name) {
  return std::ranges::find(excepted, name) != excepted.end();
}

Settings problems_of(const Catalog& catalog, const MatrixBlock& block) {
  Settings settings;
  for (const std::string& text : block.problems) {
    if (text != "*") {
      settings.add_each(text);
      continue;
    }
    for (const auto& [name, entry] : catalog.problems)
      if (entry.in_all && !is_excepted(block.except_problems, name)) settings.add(name, 1);
  }
  return settings;
}

Settings optimizers_of(const Catalog& catalog, const MatrixBlock& block) {
  Settings settings;
  for (const std::string& text : block.optimizers) {
    if (text != "*" && !text.starts_with('@')) {
      settings.add_each(text);
      continue;
    }
    for (const auto& [name, entry] : catalog.optimizers)
      if (entry.in_all && is_selected(entry, text) && !is_excepted(block.except_optimizers, name))
        settings.add(name, 1);
  }
  return settings;
}

PlanSize size_of(const Catalog& catalog, const MatrixBlock& block) {
  const Settings problems = problems_of(catalog, block);
  const Settings optimizers = optimizers_of(catalog, block);
  PlanSize size{
      .cells = product_of(block.seeds.size(), product_of(problems.total(), optimizers.total())),
      .largest = ""};
  const auto add = [&](std::uint64_t count, const std::string& words) {
    if (count > 1) size.largest += (size.largest.empty() ? "" : " × ") + words;
  };
  if (size.cells == 0) return size;
  add(block.seeds.size(), count_text(block.seeds.size()) + " seeds");
  add(problems.total(), problems.words("problems"));
  add(optimizers.total(), optimizers.words("optimizers"));
  return size;
}

}  // namespace

PlanSize size_of(const Catalog& catalog, const Suite& suite) {
  PlanSize all;
  std::uint64_t most = 0;
  for (const MatrixBlock& block : suite.blocks) {
    PlanSize size = size_of(catalog, block);
    all.cells = sum_of(all.cells, size.cells);
    if (size.cells < most) continue;
    most = size.cells;
    all.largest = std::move(size.largest);
  }
  return all;
}

std::string too_large(const PlanSize& size, std::uint64_t most) {
  return fmt::format("the plan has {} cells, more than {}: {}", count_text(size.cells),
                     count_text(most), size.largest);
}

}  // namespace isoline::benchmarks
