// Fields in the file beside a record: read back as they were written, or refused.
#include "core/records/field_frames.h"

#include <gtest/gtest.h>

#include "core/digest.h"
#include "core/errors.h"
#include "core/files.h"
#include "core/records/npy.h"
#include "tests/temporary_folder.h"

namespace isoline {
namespace {

// y*, x* and x at two iterations, of 2×3 cells.
FieldFrames small_fields() {
  FieldFrames fields{.iterations = {0, 7}, .shape = {4, 2, 3}};
  for (int i = 0; i < 24; ++i) fields.numbers.push_back(0.1F * static_cast<float>(i));
  fields.digest = digest(field_file(fields));
  return fields;
}

std::string refusal(FieldFrames fields, const std::filesystem::path& path) {
  try {
    fields.numbers.clear();
    read_field_numbers(fields, path);
    return "";
  } catch (const UsageError& error) {
    return error.what();
  }
}

TEST(FieldFrames, AreReadBackFromTheirFile) {
  const TemporaryFolder folder;
  const FieldFrames written = small_fields();
  write_text(folder.path() / "a.npy", field_file(written));
  FieldFrames read = written;
  read.numbers.clear();
  read_field_numbers(read, folder.path() / "a.npy");
  EXPECT_EQ(read.numbers, written.numbers);
  EXPECT_EQ(read.target()[1], 0.1F);
  EXPECT_EQ(read.truth()[0], 0.6F);
  EXPECT_EQ(read.x(1)[5], 2.3F);
}

TEST(FieldFrames, StandInNumPysFormat) {
  const TemporaryFolder folder;
  write_text(folder.path() / "a.npy", field_file(small_fields()));
  const NumberArray array = read_npy(folder.path() / "a.npy");
  EXPECT_EQ(array.shape, (std::vector<Index>{4, 2, 3}));
  EXPECT_EQ(array.values[23], static_cast<Real>(2.3F));
}

TEST(FieldFrames, ThatAreMissingDamagedOrAnothersAreRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.npy";
  const FieldFrames fields = small_fields();
  EXPECT_NE(refusal(fields, path).find("a.npy"), std::string::npos);
  std::string bytes = field_file(fields);
  bytes.back() ^= 1;
  write_text(path, bytes);
  EXPECT_NE(refusal(fields, path).find("is not the file that its record names"), std::string::npos);
  FieldFrames other = fields;
  other.shape = {4, 3, 2};
  write_text(path, field_file(fields));
  EXPECT_NE(refusal(other, path).find("shape"), std::string::npos);
}

TEST(FieldFrames, WhoseShapeOrIterationsCannotBeAreUnsound) {
  EXPECT_NO_THROW(require_sound(small_fields()));
  const std::vector<std::vector<Index>> shapes = {
      {5, 2, 3}, {2, 2, 3}, {4, 0, 3}, {4, 6}, {4, 2, -3}};
  for (const std::vector<Index>& shape : shapes) {
    FieldFrames fields = small_fields();
    fields.shape = shape;
    EXPECT_THROW(require_sound(fields), UsageError) << shape.size();
  }
  for (const std::vector<std::int64_t>& iterations :
       std::vector<std::vector<std::int64_t>>{{7, 7}, {-1, 7}, {7, 0}}) {
    FieldFrames fields = small_fields();
    fields.iterations = iterations;
    EXPECT_THROW(require_sound(fields), UsageError) << iterations[0];
  }
}

// y*, x and x* of float64, as earlier versions wrote them.
TEST(FieldFrames, OfOlderRecordsAreXAtTheLastIteration) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "a.npy";
  write_npy(path, {{3, 1, 1}, {1, 2, 3}});
  Exhibit pictures;
  pictures.grid = 1;
  const FieldFrames fields = frames_of(pictures, 90, path);
  EXPECT_EQ(fields.iterations, std::vector<std::int64_t>{90});
  EXPECT_EQ(fields.target()[0], 1);
  EXPECT_EQ(fields.x(0)[0], 2);
  EXPECT_EQ(fields.truth()[0], 3);
}

}  // namespace
}  // namespace isoline
