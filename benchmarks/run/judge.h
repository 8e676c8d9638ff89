// Verification of returned points outside their cells: one process per problem creates the problem
// again, evaluates one point after the other, and is replaced if a point ends it.
#pragma once

#include <poll.h>

#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "benchmarks/plan/catalog.h"
#include "benchmarks/run/isolate.h"
#include "benchmarks/run/process_group.h"

namespace isoline::benchmarks {

// The values by which a run is judged, from its trace.
struct Judged {
  double loss = 0, x_error = 0;
  double minimum = 0, scale = 0, x_scale = 0, x_floor = 0;
};

// The same values as the cell itself recorded them.
Judged told_by(const Trace& trace);

// The first of these numbers in which they differ by more than rounding, in words; "" where none
// does. Whatever is not finite must be so in both.
std::string contradiction(const Judged& told, const Judged& judged);

struct Verdict {
  std::size_t slot;
  std::optional<Judged> judged;
  std::string failure;          // the reason: "signal 11 (Segmentation fault) ended it"
  bool is_interrupted = false;  // the verifier was killed, or could not be started: try again
};

class Judges {
 public:
  // `workers` own the returned points; they are created before the first verifier, which sees their
  // shared memory.
  Judges(const Catalog& catalog, const std::vector<Worker>& workers)
      : catalog_(catalog), workers_(workers) {}
  ~Judges();
  Judges(const Judges&) = delete;
  Judges& operator=(const Judges&) = delete;

  // Has the point judged that the worker of this slot returned, within the limits of its cell.
  void ask(std::size_t slot, const Request& request, const Limits& limits);
  std::vector<Verdict> collect();  // those that have come by now
  void add_to(std::vector<pollfd>& waiting) const;

 private:
  struct Question {
    std::size_t slot;
    const Request* request;
    Limits limits;
    bool is_asked_again = false;  // a judge has died of it, or was killed over it
  };
  struct Judge {
    std::string problem;  // its specification
    ProcessGroup group = {};
    int socket = -1;
    std::deque<Question> open = {};
    LimitWatch watch = {};  // over the first of them
  };
  Judge& judge_of(const Component& problem);
  void start(Judge& judge, const Component& problem);
  void send(Judge& judge, const Question& question);
  int end(Judge& judge);  // how it ended, as wait() has it
  void watch_first(Judge& judge);
  void enforce(Judge& judge, std::vector<Verdict>& verdicts);
  void lose(Judge& judge, const std::string& reason, std::vector<Verdict>& verdicts);
  void collect(Judge& judge, std::vector<Verdict>& verdicts);

  const Catalog& catalog_;
  const std::vector<Worker>& workers_;
  std::vector<Verdict> unjudged_;  // those that no judge could be started for
  std::list<Judge> judges_;        // most recently used first
};

// The work of a verifier in its own process.

// Messages of the socket between a run and its judge.
struct PointToJudge {
  std::size_t slot;
  std::uint64_t seed;
  int threads;
};

struct JudgesReply {
  std::size_t slot;
  bool is_judged, is_interrupted;
  Judged judged;
  char failure[Trace::kText];
};

// Answers requests from the socket about points that the workers returned, until it closes. Never
// returns.
[[noreturn]] void judge_points(const Catalog& catalog, const Component& problem,
                               const std::vector<Worker>& workers, int socket);

}  // namespace isoline::benchmarks
