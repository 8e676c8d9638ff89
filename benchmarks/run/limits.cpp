// Limits of requests, and the watch over them.
#include "benchmarks/run/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/files.h"

namespace isoline::benchmarks {
namespace {

constexpr double kLookSeconds = 0.02;  // how often limits are looked at
constexpr double kLongestLook = 1;     // what is longer between two looks was no running
constexpr double kIdleShare = 0.01;    // of a core
constexpr double kBudgetFactor = 2, kDeclaredFactor = 10;

double seconds_between(std::int64_t begin, std::int64_t end) {
  return 1e-9 * static_cast<double>(end - begin);
}

LimitWatch::Breach timeout(std::string message) { return {Status::timeout, std::move(message)}; }

}  // namespace

Limits limits_of(const Request& request, const Limits& standard, double declared_seconds) {
  constexpr double kForeignStartup =
      600;  // the process adapter waits this long, and gives up first
  Limits limits = standard;
  if (request.problem.foreign || request.optimizer.foreign)
    limits.startup_seconds = std::max(limits.startup_seconds, kForeignStartup);
  const double budget = request.budget.seconds;
  if (std::isfinite(budget)) {
    limits.hard_seconds = kBudgetFactor * budget;
    limits.startup_seconds = std::max(limits.startup_seconds, limits.hard_seconds);
  } else if (request.hard_seconds > 0) {
    limits.hard_seconds = request.hard_seconds;
  } else if (std::isfinite(declared_seconds)) {
    limits.hard_seconds = std::max(standard.hard_seconds, kDeclaredFactor * declared_seconds);
  }
  return limits;
}

double DeclaredTimes::of(const Request& request) {
  constexpr double kWorkPerIteration = 3, kSecondsPerFlop = 1e-9, kCallSeconds = 1e-7;
  const Component& problem = request.problem;
  const auto [at, is_new] = sheets_.try_emplace(problem.spec);
  Sheet& sheet = at->second;
  if (is_new) try {
      sheet = {.kind = "problem", .name = problem.name, .spec = problem.spec};
      const auto path = folder_ / "components" / sheet.file_name();
      sheet = sheet_from_text(read_text(path), path.string());
    } catch (const UsageError&) {  // missing or damaged: it says nothing
    }
  const double forward_seconds = sheet.prices ? sheet.prices->forward_seconds : 0;
  if (!(forward_seconds > 0)) return 0;
  const auto iterations = static_cast<double>(request.budget.iterations),
             n = static_cast<double>(sheet.unknowns);
  const double work =
      std::min(static_cast<double>(request.budget.work), kWorkPerIteration * iterations);
  double seconds = work * (forward_seconds + kCallSeconds);
  const OracleSet needs = catalog_.optimizers.at(request.optimizer.name).needs;
  if (needs.contains(Oracle::jacobian) || needs.contains(Oracle::hessian))
    seconds += std::min(iterations, work / std::max(1.0, n)) * kSecondsPerFlop * std::pow(n, 3);
  return std::min(seconds, request.budget.seconds);
}

bool LimitWatch::is_due(std::int64_t now_nanoseconds) const {
  return seconds_between(last_nanoseconds_, now_nanoseconds) >= kLookSeconds;
}

std::optional<LimitWatch::Breach> LimitWatch::check(const ProcessGroup::Usage& usage,
                                                    bool has_asked_oracle,
                                                    std::int64_t now_nanoseconds) {
  awake_ += std::min(kLongestLook, seconds_between(last_nanoseconds_, now_nanoseconds));
  last_nanoseconds_ = now_nanoseconds;
  const Mark now{awake_, usage.processor_seconds / threads_};
  if (usage.resident_bytes > limits_.memory_bytes)
    return Breach{Status::memory,
                  fmt::format("killed: more than {} MiB resident; --memory allows more",
                              limits_.memory_bytes >> 20)};
  if (auto breach = check_time(has_asked_oracle, now)) return breach;
  if (!is_idle(usage, now)) return std::nullopt;
  Breach breach = timeout(
      fmt::format("killed: it used less than 1 % of a core for {} s", limits_.idle_seconds));
  breach.is_idleness = true;
  return breach;
}

std::optional<LimitWatch::Breach> LimitWatch::check_time(bool has_asked_oracle, const Mark& now) {
  if (has_asked_oracle && !has_begun_) {
    has_begun_ = true;
    begun_ = now;
  }
  const double most = has_begun_ ? limits_.hard_seconds : limits_.startup_seconds;
  const char* const until = has_begun_ ? "" : " without an oracle call";
  if (now.processor - begun_.processor > most)
    return timeout(fmt::format("killed after {} s of processor time{}; a longer --time allows more",
                               most, until));
  if (now.awake - begun_.awake > Limits::kWallFactor * most)
    return timeout(
        fmt::format("killed after {} s of wall time, {} times its limit of {} s of processor "
                    "time{}; a longer --time allows more",
                    Limits::kWallFactor * most, Limits::kWallFactor, most, until));
  return std::nullopt;
}

bool LimitWatch::is_idle(const ProcessGroup::Usage& usage, const Mark& now) {
  const bool is_active =
      (limits_.waits_for_others && usage.processes > 1) ||
      (now.processor - active_.processor) * threads_ >= kIdleShare * limits_.idle_seconds;
  if (is_active) active_ = now;
  return now.awake - active_.awake > limits_.idle_seconds;
}

}  // namespace isoline::benchmarks
