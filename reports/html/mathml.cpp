// Sets pieces: fractions, rows, and the words between formulas.
#include "reports/html/mathml.h"

#include <fmt/format.h>

#include "reports/html/mathml_pieces.h"

namespace isoline::reports {
namespace {

using Kind = Piece::Kind;

// How many operands stand together without a blank from `first` on, or before `last`.
std::size_t run_after(const Pieces& pieces, std::size_t first) {
  std::size_t end = first;
  while (end < pieces.size() && pieces[end].kind == Kind::operand &&
         (end == first || pieces[end].blanks == 0))
    ++end;
  return end - first;
}
std::size_t run_before(const Pieces& pieces, std::size_t last) {
  std::size_t count = 0;
  while (count < last && pieces[last - 1 - count].kind == Kind::operand &&
         (count == 0 || pieces[last - count].blanks == 0))
    ++count;
  return count;
}

std::string row_of(const Pieces& pieces, std::size_t first, std::size_t count) {
  if (count == 1) return pieces[first].inner.empty() ? pieces[first].ml : pieces[first].inner;
  std::string content;
  for (std::size_t i = first; i < first + count; ++i) content += pieces[i].ml;
  return tagged("mrow", content);
}

}  // namespace

std::string tagged(std::string_view tag, std::string_view content) {
  return fmt::format("<{0}>{1}</{0}>", tag, content);
}

Pieces with_fractions(Pieces pieces) {
  for (std::size_t i = 1; i + 1 < pieces.size(); ++i) {
    if (pieces[i].kind != Kind::slash) continue;
    const std::size_t over = run_before(pieces, i), under = run_after(pieces, i + 1);
    if (over == 0 || under == 0) continue;
    Piece fraction{
        .ml = tagged("mfrac", row_of(pieces, i - over, over) + row_of(pieces, i + 1, under)),
        .inner = "",
        .blanks = pieces[i - over].blanks};
    const auto begin = pieces.begin() + static_cast<std::ptrdiff_t>(i - over);
    pieces.erase(begin + 1, begin + static_cast<std::ptrdiff_t>(over + under + 1));
    *begin = std::move(fraction);
    i -= over;
  }
  return pieces;
}

// What stands between two pieces, and how a sign is set: a leading minus has no space around it.
std::string set_piece(const Pieces& pieces, std::size_t i) {
  const Piece& piece = pieces[i];
  if (piece.kind == Kind::word) return "<mtext>&#160;" + piece.ml + "&#160;</mtext>";
  const bool is_first = i == 0 || pieces[i - 1].kind != Kind::operand;
  if (is_first && piece.ml == "<mo>−</mo>") return "<mo form=prefix>−</mo>";
  const bool is_apart = piece.is_function && i + 1 < pieces.size() && pieces[i + 1].blanks > 0;
  return piece.ml + (is_apart ? "<mspace width=0.17em></mspace>" : "");
}

std::string set_row(const Pieces& raw) {
  const Pieces pieces = with_fractions(raw);
  std::string content;
  for (std::size_t i = 0; i < pieces.size(); ++i) content += set_piece(pieces, i);
  return content;
}

std::string mathml(std::string_view formula) {
  const Pieces pieces = with_fractions(pieces_of(formula));
  std::string html, open;
  const auto close = [&] {
    if (!open.empty()) html += tagged("math", open);
    open.clear();
  };
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool is_word = pieces[i].kind == Kind::word;
    const bool ends = pieces[i].kind == Kind::comma && i + 1 < pieces.size() &&
                      pieces[i + 1].blanks > 0;  // a line may break behind it
    if (is_word || ends) close();
    const bool is_apart = pieces[i].blanks > 0 && open.empty() && !html.empty();
    if (is_apart) html += pieces[i].blanks > 1 ? " &emsp;" : " ";
    if (is_word)
      html += pieces[i].ml;
    else if (ends)
      html += pieces[i].ml == "<mo>;</mo>" ? ";" : ",";
    else
      open += set_piece(pieces, i);
  }
  close();
  return html;
}

}  // namespace isoline::reports
