// The options of process[…], for a problem or an optimizer.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/foreign/foreign.h"
#include "core/foreign/line.h"
#include "core/options.h"
#include "core/oracle.h"
#include "core/status.h"

namespace isoline {

struct ProcessOptions {
  std::string command;
  std::string label;
  Real startup = 30;
};

void fields(ProcessOptions& o, auto& field) {
  field("command", o.command, {}, "command to start, quoted as for a shell, without expansions");
  field("label", o.label, {}, "name in tables; empty: the name that it sends");
  field("startup", o.startup, above(0), "seconds until it must introduce itself");
}

// When a call of a problem has failed, and how often that may happen in a row.
struct SimulatorOptions : ProcessOptions {
  Real call_time = 0;
  Index failures = 0, workers = 1;
  bool scales_unknowns = true;
};

void fields(SimulatorOptions& o, auto& field) {
  fields(static_cast<ProcessOptions&>(o), field);
  field("call-time", o.call_time, between(0, 1e9),
        "seconds after which a call has failed, and the program is started again; 0: no limit");
  field(
      "failures", o.failures, between(0, 1'000'000),
      "failed calls of one kind in a row that end the run; 0: 100, or 10 for each unknown if that is "
      "more");
  field("workers", o.workers, between(1, 1024),
        "copies of the program, which compute at once what a method asks for at once");
  field("scale-unknowns", o.scales_unknowns,
        "methods see each unknown divided by its size at the start, where the program declares "
        "bounds or scales of its own");
}

// The values of the options that a program has declared, out of all of a component.
OptionValues declared_values(OptionValues complete);

// The descriptions that programs have sent. Each program is started once for this, and again only
// if its command or its files change.

// How the process adapter starts a command: with the path of our clients.
ChildProgram::Start door_to(const std::string& command);

// The part of a component's Foreign that follows from its command.
Foreign foreign_of_command(const std::string& command);

// KilledProgram if the files of a component's command are no longer those that it was planned with:
// results of other files must not be stored under their digest.
void require_unedited(const std::optional<Foreign>& planned);

std::string options_text(const OptionValues& declared);  // JSON; empty without options

template <class Handshake>
class Introductions {
 public:
  template <class Greet>
  const Handshake& of(const std::string& command, const OptionValues& declared,
                      const Greet& greet) {
    const ChildProgram::Start start = door_to(command);
    const Foreign own = foreign_of_command(command);
    const std::string key = own.digest + " " + command + options_text(declared);
    if (const auto known = known_.find(key); known != known_.end()) return known->second;
    Line line(start);
    Handshake said = greet(line);
    said.foreign.door = own.door;
    said.foreign.command = own.command;
    said.foreign.digest = own.digest;
    return known_[key] = std::move(said);
  }

 private:
  std::map<std::string, Handshake> known_;
};

// The description that another program sends before any computation, as JSON, validated.

// The description of an option that is a word of a model fit, whose default a program has set.
inline constexpr const char* kWordOfScript = "a word of the fit, as the script has it";

// Common to all programs: of Foreign, its label, interpreter, packages, note and source.
struct ProblemHandshake {
  Foreign foreign;
  std::int64_t inputs = 0, outputs = 0;  // k, m
  OracleSet oracles;                     // forward, and of the others what it has
  std::int64_t pushforward_price = 1, pullback_price = 1, inverse_price = 1;
  bool are_differences = false;     // its products are quotients of forwards
  std::string inverse;              // "exact", "damped", "estimate", "approximate"; empty: none
  std::vector<Real> start, target;  // θ₀ of seed 0 (k), y* (m)
  std::vector<Real> drawn;          // θ₀ of this seed, if the program samples its own
  std::vector<Real> truth;          // x*, where it knows it
  std::vector<Real> lower, upper;   // bounds on x (k), where it has any
  bool has_active_bounds = false;   // the solution may lie on one
  std::vector<std::string> names, units;  // of the unknowns (k), where it declares them
  std::optional<Real> minimum;            // f_L, if known
  Aim aim = Aim::loss;
  bool has_own_scale = false;  // sampled starts differ by a tenth of each unknown
  bool has_x_error = false;    // it knows the distance from the nearest solution
  Real x_floor = 0;            // the error in x that its data cannot better
};

struct MethodHandshake {
  Foreign foreign;
  OracleSet needs;                // the oracles that it calls
  bool is_least_squares = false;  // it descends ½‖r‖², whatever the loss
  bool reports = false;           // its iterations; else each new best point counts as one
  bool keeps_bounds = false;      // it evaluates only points within the bounds of a problem
};

// From the text that `sender` sent. UsageError, which quotes it, if it is invalid.
ProblemHandshake problem_handshake(const std::string& text, const std::string& sender);
MethodHandshake method_handshake(const std::string& text, const std::string& sender);

// The two halves of greet_problem().
void send_greeting(Line& line, std::uint64_t seed, const OptionValues& declared);
ProblemHandshake receive_greeting(Line& line, double seconds);
// Greets a program that was just started, which has so many seconds to answer. UsageError if it
// does not answer, or if the answer is invalid.
ProblemHandshake greet_problem(Line& line, std::uint64_t seed, double seconds,
                               const OptionValues& declared);
MethodHandshake greet_method(Line& line, double seconds, const OptionValues& declared);

}  // namespace isoline
