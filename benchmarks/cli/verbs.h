// The verbs of the command line, one file each. Every one adds itself to the application.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "core/threads.h"

namespace CLI {
class App;
}

namespace isoline::reports {
struct Judgement;
struct Study;
}  // namespace isoline::reports

namespace isoline::benchmarks {

// Exit codes of every verb.
enum Exit { kGood = 0, kUsage = 1, kWorse = 2, kBetterOnly = 3, kNotComparable = 4 };
inline constexpr int kInterrupted = 130;  // what a shell expects after Ctrl-C

// What the verbs share: the catalog, made when first needed, and the way out.
class Session {
 public:
  explicit Session(std::string command) : command_(std::move(command)) {}
  const Catalog& catalog() {
    if (!catalog_) catalog_ = std::make_unique<Catalog>(builtin_catalog());
    return *catalog_;
  }
  const std::string& command() const { return command_; }
  int exit_code = kGood;

 private:
  std::string command_;
  std::unique_ptr<Catalog> catalog_;
};

// A live line of how far the work is, on a terminal; nothing elsewhere.
Listener on_terminal(const char* what);

// The claims of the tree whose cells are among the runs, judged.
std::vector<reports::Judgement> covered_claims(Session& session, const reports::Study& study);

void add_run(CLI::App& app, Session& session);
void add_report(CLI::App& app, Session& session);
void add_compare(CLI::App& app, Session& session);
void add_baseline(CLI::App& app, Session& session);
void add_merge(CLI::App& app, Session& session);
void add_claims(CLI::App& app, Session& session);
void add_list(CLI::App& app, Session& session);
void add_describe(CLI::App& app, Session& session);
void add_check(CLI::App& app, Session& session);
void add_audit(CLI::App& app, Session& session);
void add_validate(CLI::App& app, Session& session);
void add_train(CLI::App& app, Session& session);
void add_infer(CLI::App& app, Session& session);
void add_tune(CLI::App& app, Session& session);
void add_completion(CLI::App& app, Session& session);

}  // namespace isoline::benchmarks
