// Keeps data of a run beyond its curve. All calls are off the clock.
#pragma once

#include "core/status.h"

namespace isoline::optimizers {

class Meter;

class Observer {
 public:
  Observer() = default;
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;

  virtual void begin(const Meter&) {}                // before anything is evaluated
  virtual void keep(const Meter&, int /*point*/) {}  // of the curve, which the trace has then
  virtual void end(Meter&, Status /*verdict*/) {}    // at the returned point
};

}  // namespace isoline::optimizers
