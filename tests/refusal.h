// What a refusal says.
#pragma once

#include <string>

#include "core/errors.h"

namespace isoline {

// The sentence by which an action is refused, or nothing.
template <class Error = UsageError, class Action>
std::string refusal(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace isoline
