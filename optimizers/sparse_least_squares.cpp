// Sparse least squares by CHOLMOD and block elimination.
#include "optimizers/sparse_least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace isoline::optimizers {

// The Schur complement of N = AᵀA + μ in the blocks that are kept. With A = (F E), E of the
// eliminated blocks, EᵀE + μ is block diagonal, and
//   S = FᵀF + μ − FᵀE (EᵀE + μ)⁻¹ EᵀF;
// Triggs, McLauchlan, Hartley, Fitzgibbon (2000), section 6. S is sparse: it has the pairs of kept
// blocks that some residual block, or some eliminated block, joins.
class BlockSchur {
 public:
  explicit BlockSchur(const SparsePattern& pattern) : f_(pattern), kept_(pattern.first_eliminated) {
    list_members();
    list_pairs();
    for (int j = kept_; j < f_.parameter_blocks(); ++j)
      largest_ = std::max<Index>(largest_, f_.size_of(j));
    inverses_.resize((f_.columns - start_of(kept_)) * largest_);
    is_uniform_ = has_sizes(2, 9, 3);  // rows, kept, eliminated: bundle adjustment
  }

  // False where a block or S is not positive definite in rounding.
  bool factor(const Real* A, Real mu) {
    return (is_uniform_ ? eliminate<2, 9, 3>(A, mu) : eliminate<kAny, kAny, kAny>(A, mu)) &&
           reduced_.factor(S_.data(), 0);
  }
  bool solve(const Real* A, Vector& g) {  // g ← N⁻¹ g
    return is_uniform_ ? substitute<2, 9, 3>(A, g) : substitute<kAny, kAny, kAny>(A, g);
  }

 private:
  static constexpr int kAny = Eigen::Dynamic;
  template <int rows, int columns>
  using RowMajor =
      Eigen::Matrix<Real, rows, columns, columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>;
  template <int rows, int columns>
  using Part = Eigen::Map<const RowMajor<rows, columns>, 0, Eigen::OuterStride<>>;
  template <int rows, int columns>
  using Block = Eigen::Map<Eigen::Matrix<Real, rows, columns>, 0, Eigen::OuterStride<>>;
  template <int rows>
  using Segment = Eigen::Map<Eigen::Matrix<Real, rows, 1>>;

  // A kept block of a residual block: where its values begin in a row, and FᵀE in `coupling_`.
  struct Entry {
    int block, offset, coupling;
  };
  struct Joined {  // a kept block of a group
    int block, coupling;
  };
  struct Member {  // a residual block
    int first_value, width, rows;
    int first_entry, end_entry;
    int offset;  // of the eliminated block in a row
  };
  // The residual blocks that depend on one eliminated block, or on none.
  struct Group {
    int eliminated = -1;  // the block
    int first_member = 0, end_member = 0;
    int first_kept = 0, end_kept = 0;  // of `joined_`
    int coupling = 0;                  // numbers of FᵀE
  };
  // Where the pair of two kept blocks, row ≥ column, is stored in S.
  struct Column {
    std::vector<int> rows, offsets;  // of blocks ascending, and the first place of each
    int first = 0, height = 0;
  };

  int start_of(int block) const { return f_.parameter_block[static_cast<std::size_t>(block)]; }
  template <class T>
  static auto& in(T& list, int i) {
    return list[static_cast<std::size_t>(i)];
  }

  bool has_sizes(int rows, int kept, int eliminated) const {
    for (int j = 0; j < f_.parameter_blocks(); ++j)
      if (f_.size_of(j) != (j < kept_ ? kept : eliminated)) return false;
    const Group& none = groups_.back();
    return none.first_member == none.end_member &&
           std::ranges::all_of(members_, [&](const Member& m) { return m.rows == rows; });
  }

  void list_members() {
    const int eliminated = f_.parameter_blocks() - kept_;
    std::vector<std::vector<int>> by_group(static_cast<std::size_t>(eliminated) + 1);
    for (int i = 0; i < f_.residual_blocks(); ++i) {
      int group = eliminated;  // of those that depend on none
      f_.for_each_block(i, [&](int block, int) {
        if (block >= kept_) group = block - kept_;
      });
      in(by_group, group).push_back(i);
    }
    for (int g = 0; g <= eliminated; ++g) {
      Group group{.eliminated = g < eliminated ? kept_ + g : -1};
      group.first_member = static_cast<int>(members_.size());
      group.first_kept = static_cast<int>(joined_.size());
      for (const int i : in(by_group, g)) add_member(i);
      group.end_member = static_cast<int>(members_.size());
      // Kept blocks that a residual block without an eliminated one depends on are joined by it
      // alone.
      if (g < eliminated) join(group);
      group.end_kept = static_cast<int>(joined_.size());
      groups_.push_back(group);
    }
  }

  void add_member(int i) {
    const int row = in(f_.residual_block, i), first = in(f_.row_start, row);
    Member member{.first_value = first,
                  .width = in(f_.row_start, row + 1) - first,
                  .rows = in(f_.residual_block, i + 1) - row,
                  .first_entry = static_cast<int>(entries_.size()),
                  .end_entry = 0,
                  .offset = 0};
    f_.for_each_block(i, [&](int block, int offset) {
      if (block < kept_)
        entries_.push_back({block, offset, 0});
      else
        member.offset = offset;
    });
    member.end_entry = static_cast<int>(entries_.size());
    members_.push_back(member);
  }

  void join(Group& group) {
    if (group.first_member == group.end_member) return;
    const int first = in(members_, group.first_member).first_entry;
    std::map<int, int> blocks;  // with the places of their FᵀE
    for (int e = first; e < static_cast<int>(entries_.size()); ++e)
      blocks[in(entries_, e).block] = 0;
    for (auto& [block, coupling] : blocks) {
      coupling = group.coupling;
      joined_.push_back({block, coupling});
      group.coupling += f_.size_of(block) * f_.size_of(group.eliminated);
    }
    for (int e = first; e < static_cast<int>(entries_.size()); ++e)
      in(entries_, e).coupling = blocks.at(in(entries_, e).block);
    if (group.coupling > coupling_.size()) coupling_.resize(group.coupling);
  }

  // The pattern of S by compressed columns; a diagonal block is stored whole.
  void list_pairs() {
    pairs_.resize(static_cast<std::size_t>(kept_));
    for (int j = 0; j < kept_; ++j) in(pairs_, j).rows.push_back(j);
    const auto add = [&](const auto& list, int first, int end) {
      for (int a = first; a < end; ++a)
        for (int b = a + 1; b < end; ++b)
          in(pairs_, in(list, a).block).rows.push_back(in(list, b).block);
    };
    for (const Group& group : groups_) add(joined_, group.first_kept, group.end_kept);
    for (const Member& member : members_) add(entries_, member.first_entry, member.end_entry);
    for (int j = 0; j < kept_; ++j) {
      Column& column = in(pairs_, j);
      std::ranges::sort(column.rows);
      column.rows.erase(std::unique(column.rows.begin(), column.rows.end()), column.rows.end());
      column.first = static_cast<int>(S_rows_.size());
      for (const int block : column.rows) {
        column.offsets.push_back(column.height);
        column.height += f_.size_of(block);
      }
      for (int c = 0; c < f_.size_of(j); ++c) {
        S_start_.push_back(static_cast<int>(S_rows_.size()));
        for (const int block : column.rows)
          for (int i = start_of(block); i < start_of(block + 1); ++i) S_rows_.push_back(i);
      }
    }
    S_start_.push_back(static_cast<int>(S_rows_.size()));
    S_.resize(static_cast<Index>(S_rows_.size()));
    reduced_.analyse(SparseCholesky::Of::symmetric, start_of(kept_), S_start_, S_rows_);
  }

  // The pair (row, column) of S; `at` is where the search among the rows begins, and ends.
  template <int size>
  Block<size, size> pair_of(int row, int column, std::size_t& at) {
    const Column& of = in(pairs_, column);
    const auto from = of.rows.begin() + static_cast<std::ptrdiff_t>(at);
    at = static_cast<std::size_t>(std::lower_bound(from, of.rows.end(), row) - of.rows.begin());
    return {S_.data() + of.first + of.offsets[at], size == kAny ? f_.size_of(row) : size,
            size == kAny ? f_.size_of(column) : size, Eigen::OuterStride<>(of.height)};
  }

  template <int rows, int size>
  Part<rows, size> part(const Real* A, const Member& m, int offset, int columns) const {
    return {A + m.first_value + offset, m.rows, columns, Eigen::OuterStride<>(m.width)};
  }
  template <int rows, int size>
  Part<rows, size> part(const Real* A, const Member& m, const Entry& e) const {
    return part<rows, size>(A, m, e.offset, size == kAny ? f_.size_of(e.block) : size);
  }

  template <int rows, int f, int e>
  bool eliminate(const Real* A, Real mu) {
    S_.setZero();
    for (int j = 0; j < kept_; ++j) {
      std::size_t at = 0;
      pair_of<f>(j, j, at).diagonal().array() += mu;
    }
    for (const Group& group : groups_)
      if (!eliminate<rows, f, e>(A, mu, group)) return false;
    return true;
  }

  // C⁻¹ of an eliminated block, C = EᵀE + μ, (e, e).
  template <int e>
  Eigen::Map<Eigen::Matrix<Real, e, e>> inverse_of(int block) {
    const int size = e == kAny ? f_.size_of(block) : e;
    return {inverses_.data() + (start_of(block) - start_of(kept_)) * largest_, size, size};
  }

  template <int rows, int f, int e>
  bool eliminate(const Real* A, Real mu, const Group& group) {
    const bool has_block = group.eliminated >= 0;
    const int size = e != kAny ? e : has_block ? f_.size_of(group.eliminated) : 0;
    Eigen::Matrix<Real, e, e> C = Eigen::Matrix<Real, e, e>::Zero(size, size);
    coupling_.head(group.coupling).setZero();
    for (int m = group.first_member; m < group.end_member; ++m) {
      const Member& member = in(members_, m);
      const Part<rows, e> E = part<rows, e>(A, member, member.offset, size);
      if (has_block) C.noalias() += E.transpose().lazyProduct(E);
      for (int a = member.first_entry; a < member.end_entry; ++a) {
        const Entry& entry = in(entries_, a);
        const Part<rows, f> F = part<rows, f>(A, member, entry);
        if (has_block)
          W_of<f, e>(entry.block, entry.coupling, size).noalias() += F.transpose().lazyProduct(E);
        for (int b = member.first_entry; b <= a; ++b) {
          std::size_t at = 0;
          pair_of<f>(entry.block, in(entries_, b).block, at).noalias() +=
              F.transpose().lazyProduct(part<rows, f>(A, member, in(entries_, b)));
        }
      }
    }
    if (!has_block) return true;
    C.diagonal().array() += mu;
    const Eigen::LLT<Eigen::Matrix<Real, e, e>> factor(C);
    if (factor.info() != Eigen::Success) return false;
    inverse_of<e>(group.eliminated) = factor.solve(Eigen::Matrix<Real, e, e>::Identity(size, size));
    for (int b = group.first_kept; b < group.end_kept; ++b) {
      const Joined& column = in(joined_, b);
      const Eigen::Matrix<Real, f, e> T = W_of<f, e>(column.block, column.coupling, size)
                                              .lazyProduct(inverse_of<e>(group.eliminated));
      std::size_t at = 0;
      for (int a = b; a < group.end_kept; ++a) {
        const Joined& row = in(joined_, a);
        pair_of<f>(row.block, column.block, at).noalias() -=
            W_of<f, e>(row.block, row.coupling, size).lazyProduct(T.transpose());
      }
    }
    return true;
  }

  // FᵀE of a kept block, (f, e).
  template <int f, int e>
  Eigen::Map<Eigen::Matrix<Real, f, e>> W_of(int block, int coupling, int size) {
    return {coupling_.data() + coupling, f == kAny ? f_.size_of(block) : f, size};
  }

  template <int rows, int f, int e>
  bool substitute(const Real* A, Vector& g) {
    const int most = start_of(kept_);
    kept_part_ = g.head(most);
    Eigen::Matrix<Real, e, 1> z;
    Eigen::Matrix<Real, rows, 1> q;
    const auto segment = [&](Vector& of, int block) {
      return Segment<f>(of.data() + start_of(block), f_.size_of(block));
    };
    for (const Group& group : groups_) {
      if (group.eliminated < 0) continue;
      const Segment<e> own(g.data() + start_of(group.eliminated), f_.size_of(group.eliminated));
      z.noalias() = inverse_of<e>(group.eliminated).lazyProduct(own);
      for (int m = group.first_member; m < group.end_member; ++m) {
        const Member& member = in(members_, m);
        q.noalias() =
            part<rows, e>(A, member, member.offset, static_cast<int>(z.size())).lazyProduct(z);
        for (int a = member.first_entry; a < member.end_entry; ++a)
          segment(kept_part_, in(entries_, a).block).noalias() -=
              part<rows, f>(A, member, in(entries_, a)).transpose().lazyProduct(q);
      }
    }
    if (!reduced_.solve(kept_part_)) return false;
    g.head(most) = kept_part_;
    for (const Group& group : groups_) {
      if (group.eliminated < 0) continue;
      Segment<e> own(g.data() + start_of(group.eliminated), f_.size_of(group.eliminated));
      z = own;
      for (int m = group.first_member; m < group.end_member; ++m) {
        const Member& member = in(members_, m);
        q.setZero(member.rows);
        for (int a = member.first_entry; a < member.end_entry; ++a)
          q.noalias() += part<rows, f>(A, member, in(entries_, a))
                             .lazyProduct(segment(kept_part_, in(entries_, a).block));
        z.noalias() -= part<rows, e>(A, member, member.offset, static_cast<int>(z.size()))
                           .transpose()
                           .lazyProduct(q);
      }
      own.noalias() = inverse_of<e>(group.eliminated).lazyProduct(z);
    }
    return true;
  }

  const SparsePattern& f_;
  const int kept_;  // parameter blocks
  bool is_uniform_ = false;
  Index largest_ = 0;  // size of an eliminated block
  std::vector<Group> groups_;
  std::vector<Member> members_;
  std::vector<Entry> entries_;
  std::vector<Joined> joined_;  // kept blocks of each group, ascending
  std::vector<Column> pairs_;
  std::vector<int> S_start_, S_rows_;
  SparseCholesky reduced_;
  Vector S_, inverses_, coupling_, kept_part_;
};

void SparseLeastSquares::start(const SparsePattern& pattern) {
  pattern_ = &pattern;
  if (pattern.has_eliminated())
    schur_ = std::make_shared<BlockSchur>(pattern);
  else
    whole_.analyse(SparseCholesky::Of::gram, pattern.columns, pattern.row_start, pattern.column);
}

void SparseLeastSquares::set(const Vector& values, VectorRef inverse) {
  factored_ = -1;
  scaled_.resize(values.size());
  for (Index p = 0; p < values.size(); ++p)
    scaled_[p] = values[p] * inverse[pattern_->column[static_cast<std::size_t>(p)]];
}

bool SparseLeastSquares::factor(Real mu) {
  return schur_ ? schur_->factor(scaled_.data(), mu) : whole_.factor(scaled_.data(), mu);
}

bool SparseLeastSquares::apply(Vector& g) {
  return schur_ ? schur_->solve(scaled_.data(), g) : whole_.solve(g);
}

bool SparseLeastSquares::solve(Real mu, VectorRef b, Vector& s, Vector& As) {
  constexpr int kMostCorrections = 6;
  constexpr Real kEnough = 1e-10;                           // of the correction that is left out
  constexpr Real kLeastRaised = 1e-14, kMostRaised = 1e-6;  // of columns of length 1
  if (scaled_.size() != pattern_->values() || !is_finite(scaled_)) return false;
  const bool is_factored = std::exchange(factored_, -1) == mu;
  for (Real raised = mu; !is_factored && !factor(raised);
       raised = std::max(10 * raised, kLeastRaised))
    if (raised > kMostRaised) return false;
  factored_ = mu;
  s.setZero(pattern_->columns);
  As.setZero(b.size());
  Real last = std::numeric_limits<Real>::infinity();
  for (int i = 0; i <= kMostCorrections; ++i) {
    rest_ = b - As;
    correction_.resize(s.size());
    pattern_->multiply_transposed(scaled_.data(), rest_, correction_);
    correction_ -= mu * s;
    if (!apply(correction_)) return false;
    const Real length = correction_.norm();
    if (length <= kEnough * s.norm() || !(length < last)) break;
    s += correction_;
    pattern_->multiply(scaled_.data(), s, As);
    last = length / 2;  // of which the next may be at most
  }
  return is_finite(s);
}

}  // namespace isoline::optimizers
