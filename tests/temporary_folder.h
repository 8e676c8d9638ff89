// A folder that a test owns and leaves no trace of.
#pragma once

#include "core/hidden_folder.h"

namespace isoline {

using TemporaryFolder = HiddenFolder;

}  // namespace isoline
