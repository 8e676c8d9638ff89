// Two methods in succession: `first` takes a given number of steps, or stops by itself. `second`
// continues from its θ with a new state. Schnell, Holl, Thuerey (2022), published scripts, train by
// one method a network that another one has trained before.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/spec.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct ThenOptions {
  std::string first = "adam", second = "gd";
  Index steps = 100;
};

void fields(ThenOptions& o, auto& field) {
  field("first", o.first, Choices{}, "method of the first steps, with its options");
  field("second", o.second, Choices{}, "method that goes on from there, with its options");
  field("steps", o.steps, between(1, 1e9), "steps of the first");
}

// The methods of this program, for functions that get options and no registry.
const OptimizerRegistry& built_in() {
  static const OptimizerRegistry all = [] {
    OptimizerRegistry registry("optimizer");
    register_optimizers(registry);
    return registry;
  }();
  return all;
}

// An entry with the complete options of a spec.
struct Named {
  Named(const OptimizerRegistry& registry, const std::string& text)
      : entry(registry.at(parse_spec(text).name)),
        options(complete_options(entry.options, entry.name, options_of(parse_spec(text)))) {}

  const OptimizerEntry& entry;
  OptionValues options;
};

std::vector<std::string> both(const OptionValues& options) {
  return {options.text("first"), options.text("second")};
}

class Then final : public Optimizer {
 public:
  Then(const ThenOptions& options, const OptimizerRegistry& registry) : steps_(options.steps) {
    const Named first(registry, options.first), second(registry, options.second);
    first_ = first.entry.make(first.options, registry);
    second_ = second.entry.make(second.options, registry);
  }

  void start(Meter& f, const Vector& theta) override {
    meter_ = &f;
    taken_ = 0;
    first_->start(f, theta);
  }

  Status step(Meter& f, Vector& theta) override {
    if (taken_ < steps_) {
      ++taken_;
      if (first_->step(f, theta) != Status::running) taken_ = steps_;
      if (taken_ == steps_) second_->start(f, theta);
      return Status::running;
    }
    second_reports_ = second_->reports_iterations();
    return second_->step(f, theta);
  }
  bool reports_iterations() const override { return second_reports_; }

  bool persist(Archive& archive) override {
    archive(taken_);
    if (taken_ < steps_) return first_->persist(archive);
    if (archive.is_reading()) second_->start(*meter_, Vector::Zero(meter_->unknowns()));
    return second_->persist(archive);
  }

 private:
  std::unique_ptr<Optimizer> first_, second_;
  Meter* meter_ = nullptr;
  Index steps_, taken_ = 0;
  bool second_reports_ = false;  // iterations to the meter: it solves in one call
};

}  // namespace

void register_then(OptimizerRegistry& registry) {
  OptimizerEntry entry{.name = "then",
                       .title = "Two methods in turn",
                       .family = Family::first_order,
                       .kind = Kind::gradient,
                       .formula = "first, for a number of steps; then second, from its θ",
                       .source = "Schnell, Holl, Thuerey (2022), published scripts",
                       .needs = {Oracle::forward},
                       .in_all = false};
  entry.options = option_table<ThenOptions>();
  entry.needs_for = [](const OptionValues& options, const Problem& problem) {
    OracleSet needs;
    for (const std::string& text : both(options)) {
      const Named named(built_in(), text);
      const OracleSet own = needs_of(named.entry, named.options, problem);
      for (std::size_t kind = 0; kind < kOracles; ++kind)
        if (own.contains(static_cast<Oracle>(kind))) needs.add(static_cast<Oracle>(kind));
    }
    return needs;
  };
  entry.inside = [](const OptionValues& options, bool) { return both(options); };
  entry.objection = [](const OptionValues& options, const Problem& problem) -> std::string {
    for (const std::string& text : both(options)) {
      const Named named(built_in(), text);
      if (std::string why = why_inapplicable(named.entry, named.options, problem); !why.empty())
        return named.entry.name + ": " + why;
    }
    const Named first(built_in(), options.text("first"));
    if (first.entry.make(first.options, built_in())->reports_iterations())
      return first.entry.name + " solves in one call, which has no steps to count";
    return "";
  };
  entry.make = [](const OptionValues& options,
                  const OptimizerRegistry& known) -> std::unique_ptr<Optimizer> {
    return std::make_unique<Then>(read_options<ThenOptions>(options), known);
  };
  registry.add(std::move(entry));
}

}  // namespace isoline::optimizers
