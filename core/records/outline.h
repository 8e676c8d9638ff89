// A JSON text as what its single values are held to laws by: a tree in which long columns are
// short.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace isoline {

// Of a long list of numbers and texts its least and greatest integer, its least and greatest other
// number, and each of its texts once: laws on the kind, the bounds or the choices of an element
// hold for these where they hold for all. Laws on a list's length or order need the whole tree.
// UsageError names the origin where it is no JSON.
nlohmann::json outline_of(const std::string& text, const std::string& origin);

}  // namespace isoline
