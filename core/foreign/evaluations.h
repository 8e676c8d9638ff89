// The store of evaluations: what calls to problems in other programs answered, in the files
// `evaluations/*.calls` of a result folder. Any later call for the same numbers, bit for bit, is
// answered from it: of another method or budget, of a check, of a run that was killed. And, without
// files, the last calls of this process, however quick they were: a method and its judge ask for
// one point.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/calls.h"
#include "core/foreign/line.h"
#include "core/options.h"
#include "core/real.h"

namespace isoline {

inline constexpr double kSlowSeconds = 0.1;  // a call from which on an answer is worth its bytes

// Identity of a problem's answers: the command with the files that it names, the options
// that its program declares; and the seed that the program gets.
struct EvaluationKey {
  std::string problem;  // a digest
  std::uint64_t seed = 0;
  std::string command;

  EvaluationKey(std::string command, const OptionValues& declared, std::uint64_t seed);
  std::string stem() const;  // of its files: "9c1d52aa4711beef.0"
};

class Evaluations {
 public:
  using Numbers = std::span<const std::span<const Real>>;

  struct Settings {
    std::filesystem::path folder = {};  // the result folder; empty: nothing is kept or answered
    bool keeps_all = false;             // also what took less than kSlowSeconds
    bool answers = true;                // else only keeps
    bool answers_failures = true;       // else makes calls again that failed
  };
  // From now on; what is open is closed.
  void begin(Settings settings);

  // The answer of one of the last calls, or the one that is stored, and why the call failed, empty
  // if it did not. A call that was late is no answer where more time is allowed now.
  std::optional<std::string> find(const EvaluationKey& key, Verb verb, Numbers request,
                                  std::span<Real> answer, double most_seconds);
  bool has(const EvaluationKey& key, Verb verb, Numbers request);
  // For the next calls, if it is remembered; stores it where it took long enough.
  void keep(const EvaluationKey& key, Verb verb, Numbers request, std::span<const Real> answer,
            const std::string& why, double seconds, bool is_late, bool is_remembered = true);
  double answered_seconds() const { return answered_seconds_; }  // that they took when made

 private:
  struct Head;
  struct File;
  struct Stored;
  struct Recent {
    std::uint64_t place;
    std::string stem, request, why;
    std::vector<Real> answer;
  };
  Stored& stored(const EvaluationKey& key);
  static void read_on(Stored& of, const std::filesystem::path& folder);
  bool open_for_writing(Stored& of, const EvaluationKey& key);

  const Recent* recent(const EvaluationKey& key, Verb verb, std::string_view request) const;
  void remember(Recent call);

  Settings settings_;
  std::deque<Recent> recent_;  // forward calls, the last one first
  std::size_t recent_numbers_ = 0;
  std::map<std::string, std::shared_ptr<Stored>> stored_;  // by stem
  double answered_seconds_ = 0;
};

// That of this process.
inline Evaluations& evaluations() {
  static Evaluations all;
  return all;
}

// The files of a problem with any seed, or of one, in a result folder.
std::vector<std::filesystem::path> evaluation_files(const std::filesystem::path& folder,
                                                    std::string_view stem);

// While one lives, calls are made, whatever the store has: for comparison with known answers.
class Afresh {
 public:
  Afresh() : before_(std::exchange(is_on_, true)) {}
  ~Afresh() { is_on_ = before_; }
  Afresh(const Afresh&) = delete;
  Afresh& operator=(const Afresh&) = delete;
  static bool is_on() { return is_on_; }

 private:
  inline static bool is_on_ = false;
  bool before_;
};

// A clock, in seconds, on which a call that the store answers takes the time that it took.
double call_clock();

}  // namespace isoline
