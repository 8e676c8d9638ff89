// CSV as RFC 4180 has it, row by row, from text that anybody may have written.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace isoline::benchmarks {

// Fields between commas, bare or in double quotes with quotes inside doubled; lines end by LF or
// CRLF; a mark of byte order at the beginning is none of the text; empty lines are passed over.
class CsvRows {
 public:
  CsvRows(std::string_view text, std::string origin);

  // The next row's fields, blanks at their ends left out; false at the end. UsageError, which names
  // the line, where quotes are not closed or stand in the middle of a field.
  bool next(std::vector<std::string>& fields);
  std::size_t line() const { return row_line_; }  // where the row begins, from 1

 private:
  std::string field();
  std::string quoted_field();
  bool is_at_end_of_row() const;
  void end_row();
  [[noreturn]] void refuse(const char* why) const;

  std::string_view text_;
  std::string origin_;
  std::size_t at_ = 0, line_ = 1, row_line_ = 1;
};

}  // namespace isoline::benchmarks
