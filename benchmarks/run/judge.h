// Verification of returned points outside their cells: one process per problem creates the problem
// again, evaluates one point after the other, and is replaced if a point ends it.
#pragma once

#include <poll.h>

#include <cstdint>
#include <deque>
#include <filesystem>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/run/isolate.h"

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
  std::int64_t afresh = 0, afresh_failed = 0;  // calls to another program for the point
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

  // Has the point judged that the worker of this slot returned, within the limits of its cell. The
  // store of evaluations in `folder`, where that is named, answers the calls to a slow program,
  // with the exception of those at the point.
  void ask(std::size_t slot, const Request& request, const Limits& limits,
           const std::filesystem::path& folder);
  std::vector<Verdict> collect();  // those that have come by now
  void add_to(std::vector<pollfd>& waiting) const;

 private:
  struct Question {
    std::size_t slot;
    const Request* request;
    Limits limits;
    std::filesystem::path folder;
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
  static void send(Judge& judge, const Question& question);
  static int end(Judge& judge);  // how it ended, as wait() has it
  static void watch_first(Judge& judge);
  void enforce(Judge& judge);
  void lose(Judge& judge, const std::string& reason);
  void collect(Judge& judge);

  const Catalog& catalog_;
  const std::vector<Worker>& workers_;
  std::vector<Verdict> verdicts_;  // that are not collected yet
  std::list<Judge> judges_;        // most recently used first
};

}  // namespace isoline::benchmarks
