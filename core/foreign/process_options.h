// What process[…] is given, be it a problem or an optimizer.
#pragma once

#include <string>

#include "core/options.h"

namespace isoline {

struct ProcessOptions {
  std::string command;
  std::string label;
  Real startup = 30;
};

void fields(ProcessOptions& o, auto& field) {
  field("command", o.command, {}, "what is started: words as of a shell, nothing expanded");
  field("label", o.label, {}, "what tables call it; empty: what it calls itself");
  field("startup", o.startup, above(0), "seconds in which it must have introduced itself");
}

}  // namespace isoline
