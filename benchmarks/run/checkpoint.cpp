// Checkpoints: written whole or not at all, read only by the cell and build that wrote them.
#include "benchmarks/run/checkpoint.h"

#include <csignal>

#include "core/clock.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/json.h"

namespace isoline::benchmarks {
namespace {

constexpr const char* kFormat = "isoline.checkpoint/2 ";

constexpr std::size_t kDigits = 16;  // of the digest that follows

volatile std::sig_atomic_t stop_requested = 0;

}  // namespace

Checkpoint::Checkpoint(std::filesystem::path path, std::string identity, double every_seconds)
    : path_(std::move(path)),
      identity_(kFormat + std::move(identity) + "\n"),
      every_seconds_(every_seconds),
      last_nanoseconds_(monotonic_nanoseconds()) {
  stop_requested = 0;
  std::signal(SIGTERM, [](int) { stop_requested = 1; });
}

bool Checkpoint::restore(Optimizer& method, Meter& meter, Vector& theta) {
  std::error_code error;
  if (path_.empty() || !std::filesystem::exists(path_, error)) return false;
  std::string bytes;
  try {
    bytes = read_text(path_);
  } catch (const UsageError&) {
    return false;
  }
  if (!bytes.starts_with(identity_)) return false;
  bytes.erase(0, identity_.size());
  const std::string sum = bytes.substr(0, kDigits);
  bytes.erase(0, kDigits);
  if (sum != digest(bytes)) return false;
  try {
    read(std::move(bytes), method, meter, theta);
  } catch (const std::exception& cause) {
    set_aside();
    throw DamagedCheckpoint(cause.what());
  }
  return true;
}

void Checkpoint::read(std::string bytes, Optimizer& method, Meter& meter, Vector& theta) const {
  Archive archive(std::move(bytes));
  method.start(meter, theta);
  archive(theta);
  require(theta.size() == meter.unknowns(), "it has another number of unknowns");
  require(method.persist(archive), "the method stores no state");
  meter.persist(archive);
  require(archive.bytes_left() == 0, "it holds more than the state of this run");
}

// To be looked at, and out of the way.
void Checkpoint::set_aside() {
  std::error_code error;
  std::filesystem::rename(path_, path_.string() + ".damaged", error);
  if (error) path_.clear();  // nor is it read again, or written over
}

bool Checkpoint::save_if_due(Optimizer& method, Meter& meter, Vector& theta) {
  if (path_.empty()) return false;
  const std::int64_t now = monotonic_nanoseconds();
  const bool is_due = 1e-9 * static_cast<double>(now - last_nanoseconds_) >= every_seconds_;
  if (!is_due && !stop_requested) return false;
  save(method, meter, theta);
  last_nanoseconds_ = now;
  return stop_requested != 0;
}

void Checkpoint::save(Optimizer& method, Meter& meter, Vector& theta) const {
  Archive archive;
  archive(theta);
  if (!method.persist(archive)) return;
  meter.persist(archive);
  try {
    write_text(path_, identity_ + digest(archive.bytes()) + archive.bytes());
  } catch (const std::exception&) {  // a full disk costs the checkpoint, not the run
  }
}

}  // namespace isoline::benchmarks
