// Records, plans and sheets as they stand in their files.
#pragma once

#include <cstddef>
#include <string>

namespace isoline {

struct Plan;
struct Record;
struct Sheet;

std::string file_text(const Record& record);
std::string file_text(const Plan& plan);
std::string file_text(const Sheet& sheet);

// Most of a record's file, or that of its pictures: ours have some tens of thousands.
inline constexpr std::size_t kMostRecordBytes = std::size_t{64} << 20;

}  // namespace isoline
