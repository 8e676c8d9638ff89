// Runs an optimizer as the harness does, and keeps its path.
#include "benchmarks/audit/audit_subject.h"

#include "benchmarks/run/execute.h"

namespace isoline::benchmarks {
namespace {

constexpr std::int64_t kStepsToMove = 8;  // in which a first step may be rejected

OracleSet every_oracle() {
  OracleSet all;
  for (std::size_t kind = 0; kind < kOracles; ++kind) all.add(static_cast<Oracle>(kind));
  return all;
}

// Keeps θ after every step; of a library's solver the trace keeps as many as there is room for.
class Recorded final : public Optimizer {
 public:
  Recorded(Optimizer& method, std::vector<Vector>& path) : method_(method), path_(path) {}
  void start(Meter& f, const Vector& theta) override {
    if (!reports_iterations()) path_.push_back(theta);
    method_.start(f, theta);
  }
  Status step(Meter& f, Vector& theta) override {
    const Status status = method_.step(f, theta);
    if (!reports_iterations()) path_.push_back(theta);
    return status;
  }
  bool reports_iterations() const override { return method_.reports_iterations(); }

 private:
  Optimizer& method_;
  std::vector<Vector>& path_;
};

}  // namespace

std::string Subject::why_inapplicable(const Problem& problem) const {
  return optimizers::why_inapplicable(entry_, options_, problem);
}

OracleSet Subject::needs(const Problem& problem) const {
  return needs_of(entry_, options_, problem);
}

Path Subject::run(const Problem& problem, std::int64_t iterations) const {
  const auto trace = std::make_unique<Trace>();  // large
  Path path;
  try {
    const auto method = entry_.make(options_, catalog_.optimizers);
    Recorded recorded(*method, path.x);
    Meter meter(problem, {.iterations = iterations, .target = 0}, every_oracle(), *trace);
    Checkpoint checkpoint;
    drive(recorded, meter, problem.start(), checkpoint);
  } catch (const std::exception&) {  // what it did until then is judged
  }
  path.counts = trace->last.counts;
  path.iterations = trace->last.iteration;
  if (path.x.empty())
    for (int i = 0; i < trace->points; ++i)
      path.x.emplace_back(Eigen::Map<const Vector>(trace->path_x[i], trace->path_inputs));
  return path;
}

std::optional<Vector> Subject::first_step(const Problem& problem) const {
  if (!why_inapplicable(problem).empty()) return std::nullopt;
  for (const Vector& x : run(problem, kStepsToMove).x)
    if (x != problem.start()) return x - problem.start();
  return std::nullopt;
}

}  // namespace isoline::benchmarks
