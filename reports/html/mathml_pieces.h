// A formula as a sequence of pieces; a piece is an atom with its scripts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace isoline::reports {

struct Piece {
  enum class Kind { operand, sign, comma, slash, word };
  Kind kind = Kind::operand;
  std::string ml;     // MathML; of a word its letters
  std::string inner;  // of a group in parentheses: what is inside them
  int blanks = 0;     // before it
  bool is_function = false;
};
using Pieces = std::vector<Piece>;

Pieces pieces_of(std::string_view formula);

// Pieces as one row of MathML, or each of them by itself. Fractions are found among pieces: a/b
// takes what stands without a blank on either side.
Pieces with_fractions(Pieces pieces);
std::string set_piece(const Pieces& pieces, std::size_t i);
std::string set_row(const Pieces& pieces);

std::string tagged(std::string_view tag, std::string_view content);  // "<tag>content</tag>"

}  // namespace isoline::reports
