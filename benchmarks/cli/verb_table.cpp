// Each verb: its name, what it does, and what it is given and run with.
#include "benchmarks/cli/verb_table.h"

#include "benchmarks/cli/session.h"
#include "benchmarks/cli/verb_arguments.h"

namespace isoline::benchmarks {
namespace {

// The libraries that a verb is given, where it takes any.
template <class Arguments>
std::vector<std::string> plugins_of(const Arguments& given) {
  if constexpr (requires { given.plugins; })
    return given.plugins;
  else if constexpr (requires { given.run.plugins; })
    return given.run.plugins;
  else
    return {};
}

class VerbList {
 public:
  template <class Arguments>
  std::shared_ptr<Arguments> add(const char* name, const std::string& about,
                                 int (*verb)(const Arguments&, Session&)) {
    const auto given = std::make_shared<Arguments>();
    const auto run = [given, verb](Session& session) {
      session.set_plugins(plugins_of(*given));
      return verb(*given, session);
    };
    verbs_.push_back({name, about, [given](VerbArguments& of) { declare(of, *given); }, run});
    return given;
  }
  std::vector<Verb> verbs() const { return verbs_; }

 private:
  std::vector<Verb> verbs_;
};

std::shared_ptr<const RunArguments> add_verbs_on_results(VerbList& to) {
  const auto run = to.add(
      "run", "Run a suite or a matrix of your own; what is done already is not repeated", run_verb);
  to.add("plan", "Tell what a run would do, how long it may take, and how it divides into shards",
         plan_verb);
  to.add("report", "Write " + format_names(), report_verb);
  to.add("compare", "Compare two results and list regressions", compare_verb);
  to.add("baseline", "Keep what later results are compared with, as one small file", baseline_verb);
  to.add("replay", "Run the cell of a record again, and check the two for equality bit for bit",
         replay_verb);
  to.add("merge", "Unite result folders into a new one", merge_verb);
  to.add("submit", "Hand a run to a cluster's scheduler, as two jobs", submit_verb);
  to.add("status", "Tell how far a run is, while it goes on", status_verb);
  to.add("best", "Keep the best losses of runs, where no least loss is declared", best_verb);
  to.add("claims", "Judge what papers claim by runs; what is missing is run first", claims_verb);
  to.add("export", "Write curves as CSV, as data of COCO, or as metrics of Bencher", export_verb);
  return run;
}

void add_verbs_on_components(VerbList& to) {
  to.add("list", "List the problems, networks, optimizers and suites", list_verb);
  to.add("describe", "Show the formula, options, needs and source of a component", describe_verb);
  to.add("check", "Check a problem's derivatives, adjoint and inverse against each other",
         check_verb);
  to.add("audit", "Measure optimizers' scaling, invariance, order, consistency and oracles",
         audit_verb);
  to.add("new", "Write the file that a problem or optimizer of your own starts from", new_verb);
  to.add("validate",
         "Validate records, suites and all other JSON files of Isoline by their schemas",
         validate_verb);
  to.add("tune", "Choose one option of each method for each problem, with an equal budget for all",
         tune_verb);
  to.add("train", "Train a network on a learning problem and write it to a file", train_verb);
  to.add("infer", "Apply a network that `isoline train` wrote to observations", infer_verb);
}

}  // namespace

VerbTable verb_table() {
  VerbList list;
  const auto run = add_verbs_on_results(list);
  add_verbs_on_components(list);
  const auto completion =
      list.add("completion", "Print the completion script of a shell", completion_verb);
  return {list.verbs(), run, completion};
}

}  // namespace isoline::benchmarks
