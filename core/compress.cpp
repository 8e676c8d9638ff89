// Compressed bytes, by zlib.
#include "core/compress.h"

#include <zlib.h>

#include <new>

namespace isoline {

std::string compressed(std::string_view bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  if (compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(),
                Z_BEST_COMPRESSION) != Z_OK)
    throw std::bad_alloc();  // the only failure where the output has this size
  out.resize(size);
  return out;
}

}  // namespace isoline
