// Labels as narrow places show them.
#pragma once

#include <string>
#include <vector>

namespace isoline::reports {

// Of long labels the options alone that tell them from others of their method: those that all of
// the method share are left out, in "sip[inverse=newton,network-optimizer=adam[rate=1e-3]]" beside
// "sip[inverse=analytic,network-optimizer=adam[rate=1e-3]]" the network's optimizer. No two become
// the same.
std::vector<std::string> brief_labels(const std::vector<std::string>& labels);

}  // namespace isoline::reports
