// A folder that a test owns and leaves no trace of.
#pragma once

#include "core/files.h"

namespace isoline {

using TemporaryFolder = HiddenFolder;

}  // namespace isoline
