// Names of the options by which a network learns a problem. Problems declare them
// (problems/learning.h); plans, records and reports read them.
#pragma once

#include <array>

namespace isoline {

inline constexpr const char *kModeOption = "mode", *kDirectMode = "direct", *kLearnMode = "learn";
inline constexpr const char *kNetworkOption = "network", *kBatchOption = "batch",
                            *kDataOption = "data", *kEpochOption = "epoch", *kWatchOption = "watch";
inline constexpr std::array kLearningOptions = {kModeOption, kNetworkOption, kBatchOption,
                                                kDataOption, kEpochOption,   kWatchOption};

}  // namespace isoline
