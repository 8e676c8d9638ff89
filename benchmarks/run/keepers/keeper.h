// Data of a run beyond its curve: each file here fills one part of a record
// (core/records/parts). Its data are plain and of fixed size, in the trace, so that they outlive
// the process of the run.
#pragma once

#include <memory>
#include <new>
#include <string>
#include <type_traits>
#include <vector>

#include "core/records/parts.h"
#include "core/trace.h"
#include "optimizers/meter.h"

namespace isoline::benchmarks {

using optimizers::Meter;

struct Keeper {
  std::size_t bytes;  // of its data
  void (*construct)(void* kept);
  std::unique_ptr<optimizers::Observer> (*observe)(void* kept);
  std::string (*defect)(const void* kept);  // what another process has overwritten; empty: none
  void (*write)(const void* kept, const Trace& trace, Parts& parts);
};

template <class Kept>
class KeepingObserver final : public optimizers::Observer {
 public:
  explicit KeepingObserver(Kept& kept) : kept_(kept) {}
  void begin(const Meter& f) override {
    if constexpr (requires { kept_.begin(f); }) kept_.begin(f);
  }
  void keep(const Meter& f, int point) override {
    if constexpr (requires { kept_.keep(f, point); }) kept_.keep(f, point);
  }
  void end(Meter& f, Status verdict) override {
    if constexpr (requires { kept_.end(f, verdict); }) kept_.end(f, verdict);
  }

 private:
  Kept& kept_;
};

// `Kept` has write(trace, parts) and, as far as it needs them, begin(f), keep(f, point),
// end(f, verdict) and defect().
template <class Kept>
Keeper keeper_of() {
  static_assert(std::is_trivially_copyable_v<Kept>);
  return {.bytes = sizeof(Kept),
          .construct = [](void* kept) { new (kept) Kept; },
          .observe = [](void* kept) -> std::unique_ptr<optimizers::Observer> {
            return std::make_unique<KeepingObserver<Kept>>(*static_cast<Kept*>(kept));
          },
          .defect = [](const void* kept) -> std::string {
            if constexpr (requires(const Kept& data) { data.defect(); })
              return static_cast<const Kept*>(kept)->defect();
            else
              return "";
          },
          .write = [](const void* kept, const Trace& trace,
                      Parts& parts) { static_cast<const Kept*>(kept)->write(trace, parts); }};
}

// Each NAME.cpp of this folder defines Keeper NAME_keeper(); the build lists them.
const std::vector<Keeper>& keepers();

optimizers::Observers open_keepers(Trace& trace);  // with their data new
// The error in a trace that another process may have overwritten, and in the data of keepers.
std::string defect_of_all(const Trace& trace);
void write_parts(const Trace& trace, Parts& parts);

std::vector<std::string> lines_of(const char* text);

}  // namespace isoline::benchmarks
