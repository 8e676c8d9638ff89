// Reads CSV letter by letter.
#include "benchmarks/import/csv_rows.h"

#include <fmt/format.h>

#include <utility>

#include "core/errors.h"

namespace isoline::benchmarks {
namespace {

std::string trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return std::string(first == std::string_view::npos ? "" : text.substr(first, last - first + 1));
}

}  // namespace

CsvRows::CsvRows(std::string_view text, std::string origin)
    : text_(text), origin_(std::move(origin)) {
  constexpr std::string_view kByteOrder = "\xEF\xBB\xBF";
  if (text_.starts_with(kByteOrder)) at_ = kByteOrder.size();
}

void CsvRows::refuse(const char* why) const {
  throw UsageError(fmt::format("{}: line {}: {}", origin_, line_, why));
}

bool CsvRows::is_at_end_of_row() const {
  return at_ == text_.size() || text_[at_] == '\n' || text_.substr(at_, 2) == "\r\n";
}

void CsvRows::end_row() {
  if (at_ < text_.size() && text_[at_] == '\r') ++at_;
  if (at_ < text_.size()) {
    ++at_;
    ++line_;
  }
}

std::string CsvRows::quoted_field() {
  std::string field;
  for (++at_; at_ < text_.size(); ++at_) {
    if (text_[at_] == '\n') ++line_;
    if (text_[at_] == '"' && text_.substr(at_, 2) != "\"\"") {
      ++at_;
      while (at_ < text_.size() && text_[at_] == ' ') ++at_;
      if (!is_at_end_of_row() && text_[at_] != ',') refuse("a text goes on after its quotes");
      return field;
    }
    if (text_[at_] == '"') ++at_;
    field += text_[at_];
  }
  line_ = row_line_;
  refuse("it opens quotes that are not closed");
}

std::string CsvRows::field() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t')) ++at_;
  if (at_ < text_.size() && text_[at_] == '"') return quoted_field();
  const std::size_t begin = at_;
  while (!is_at_end_of_row() && text_[at_] != ',') {
    if (text_[at_] == '"') refuse("quotes stand in the middle of a field");
    if (text_[at_] == '\0') refuse("it holds a zero byte");
    ++at_;
  }
  return trimmed(text_.substr(begin, at_ - begin));
}

bool CsvRows::next(std::vector<std::string>& fields) {
  fields.clear();
  while (at_ < text_.size()) {
    row_line_ = line_;
    if (is_at_end_of_row()) {
      end_row();
      continue;
    }
    for (fields.push_back(field()); !is_at_end_of_row(); fields.push_back(field())) ++at_;
    end_row();
    return true;
  }
  return false;
}

}  // namespace isoline::benchmarks
