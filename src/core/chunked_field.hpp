// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "chunks.hpp"
#include "foreign.hpp"

namespace bezsoma {

/// How a field of any degree and number of components travels between the vectors of a mesh and
/// the chunks that threads work on: read into scratch, written back in two steps, so that no two
/// threads add to one number and sums keep their order. (ElasticOperator does without the copies
/// of own controls, which are most of what it would move: it works on the vectors in place.)
template <class T> class ChunkedField {
public:
    ChunkedField(Chunks chunks, int components)
        : chunks_(std::move(chunks)), components_(components),
          foreign_(static_cast<std::size_t>(components * chunks_.foreign)) {}

    const Chunks &chunks() const { return chunks_; }
    std::size_t parts() const { return chunks_.parts.size(); }
    std::int64_t controls() const { return chunks_.controls; }

    /// Gives back the memory of `Chunks::local`, once `LanesOfTets` has made its own of it.
    void forget_local() { std::vector<std::int32_t>().swap(chunks_.local); }

    /// The most numbers that a chunk's controls take, with the padding.
    std::size_t longest() const {
        return static_cast<std::size_t>(components_ * std::int64_t{chunks_.largest}) + padding;
    }

    /// The controls of a chunk, own ones first: what kernels find by their local numbers.
    void read(std::size_t part, const T *from, T *to) const {
        const Chunk &chunk = chunks_.parts[part];
        const auto wide = std::int64_t{components_};
        to = std::copy_n(from + wide * chunk.control, wide * chunk.owned, to);
        copy_rows(chunk.foreign, from, wide, to);
    }

    /// First step: what a chunk found for its own controls goes to the vector, the rest beside.
    void write(std::size_t part, const T *from, T *to) {
        const Chunk &chunk = chunks_.parts[part];
        const auto wide = std::int64_t{components_};
        std::copy_n(from, wide * chunk.owned, to + wide * chunk.control);
        std::copy_n(from + wide * chunk.owned, wide * std::ssize(chunk.foreign),
                    foreign_.data() + wide * chunk.foreign_begin);
    }

    /// Second step, when all chunks have done the first: adds what others found for its own.
    void add_foreign(std::size_t part, T *to) const {
        const auto wide = std::int64_t{components_};
        add_rows(chunks_.parts[part].added, foreign_.data(), to, wide);
    }

private:
    Chunks chunks_;
    int components_;
    std::vector<T> foreign_; // (foreign controls, components)
};

/// Tets in batches of one per lane, chunk by chunk; the last batch of a chunk may be part full.
class LanesOfTets {
public:
    LanesOfTets(const Chunks &chunks, int lanes) : lanes_(lanes), batch_{0} {
        for (const Chunk &chunk : chunks.parts)
            batch_.push_back(batch_.back() + (chunk.tets + lanes - 1) / lanes);
    }

    std::int64_t batches() const { return batch_.back(); }
    std::int64_t first(std::size_t part) const { return batch_[part]; }
    std::int64_t count(std::size_t part) const { return batch_[part + 1] - batch_[part]; }
    int lanes() const { return lanes_; }

    /// Calls visit(tet of the walk, batch, lane) for the tets of a chunk.
    template <class Visit>
    void each(const Chunks &chunks, std::size_t part, const Visit &visit) const {
        const Chunk &chunk = chunks.parts[part];
        for (std::int64_t i = 0; i < chunk.tets; ++i)
            visit(chunk.tet + i, batch_[part] + i / lanes_, i % lanes_);
    }

    /// Where each entity's run begins in its chunk, (batches, entities, lanes), in numbers, from
    /// `Chunks::local`. Lanes without a tet read control 0.
    std::vector<std::int32_t> runs(const Chunks &chunks, std::int32_t components) const {
        const std::int64_t per_tet = entities_of_tet(chunks.degree);
        std::vector<std::int32_t> found(static_cast<std::size_t>(batches() * per_tet * lanes_));
        for (std::size_t part = 0; part < chunks.parts.size(); ++part)
            each(chunks, part, [&](std::int64_t tet, std::int64_t batch, std::int64_t lane) {
                for (std::int64_t e = 0; e < per_tet; ++e)
                    found[static_cast<std::size_t>((batch * per_tet + e) * lanes_ + lane)] =
                        components * chunks.local[static_cast<std::size_t>(tet * per_tet + e)];
            });
        return found;
    }

private:
    int lanes_;
    std::vector<std::int64_t> batch_; // (chunks + 1,)
};

} // namespace bezsoma
