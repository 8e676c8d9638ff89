// Whoever optimizes a problem that `isoline serve --record` offers: a method that this program does
// not run, but answers. Its record names it; nothing can make it again.
#include "core/digest.h"
#include "optimizers/optimizer.h"

namespace isoline::optimizers {
namespace {

struct Options {
  std::string client = "?";
};
void fields(Options& o, auto& field) {
  field("client", o.client, Choices{}, "what whoever asks is called");
}

constexpr const char* kWhy =
    "it stands for whoever asks `isoline serve --record`, and cannot be run from here";

Foreign introduce(const OptionValues& options) {
  const std::string client = options.text("client");
  return {.door = "umbridge",
          .command = client,
          .digest = digest(""),
          .label = client == "?" ? "" : client,
          .note = "Asked a served problem over HTTP; what it is made of is not known."};
}

}  // namespace

void register_served(OptimizerRegistry& registry) {
  registry.add(
      {.name = "served",
       .title = "Whoever asks a served problem",
       .family = Family::foreign,
       .kind = Kind::other,
       .formula = "θ ← whatever it evaluates that is better than before",
       .source = "UM-Bridge: Seelinger et al. (2023)",
       .note = "An iteration is a new best evaluation. Its time is that from its first "
               "call to its last, HTTP and its own work included.",
       .needs = {Oracle::forward},
       .options = option_table<Options>(),
       .in_all = false,
       .needs_argument = "served[client=…]",
       .introduce = introduce,
       .objection = [](const OptionValues&, const Problem&) { return kWhy; },
       .make = [](const OptionValues&, const OptimizerRegistry&) -> std::unique_ptr<Optimizer> {
         throw NotApplicable(kWhy);
       }});
}

}  // namespace isoline::optimizers
