// SPDX-License-Identifier: BSD-3-Clause
#include "block_csr.hpp"

#include <algorithm>

namespace bezsoma {

Incidence incidence(const std::int64_t *of_tet, std::size_t tets, std::size_t per_tet,
                    std::size_t controls, Team &team) {
    const std::size_t entries = tets * per_tet;
    Incidence in{std::vector<std::int64_t>(controls + 1, 0), std::vector<std::int64_t>(entries)};
    in_turn(team, entries,
            [&](std::size_t e) { ++in.start[static_cast<std::size_t>(of_tet[e]) + 1]; });
    for (std::size_t c = 0; c < controls; ++c)
        in.start[c + 1] += in.start[c];
    std::vector<std::int64_t> next(in.start.begin(), in.start.end() - 1);
    in_turn(team, entries, [&](std::size_t e) {
        auto &slot = next[static_cast<std::size_t>(of_tet[e])];
        in.entry[static_cast<std::size_t>(slot++)] = static_cast<std::int64_t>(e);
    });
    return in;
}

namespace {

/// The neighbours of control c, ascending; `neighbours` is emptied and filled.
void neighbours_of(std::size_t c, const Incidence &in, const std::int64_t *of_tet,
                   std::size_t per_tet, std::vector<std::int32_t> &seen_by,
                   std::vector<std::int32_t> &neighbours) {
    neighbours.clear();
    const auto me = static_cast<std::int32_t>(c);
    for (auto e = in.start[c]; e < in.start[c + 1]; ++e) {
        const auto tet = static_cast<std::size_t>(in.entry[static_cast<std::size_t>(e)]) / per_tet;
        for (std::size_t b = 0; b < per_tet; ++b) {
            const auto other = of_tet[tet * per_tet + b];
            auto &seen = seen_by[static_cast<std::size_t>(other)];
            if (seen != me) {
                seen = me;
                neighbours.push_back(static_cast<std::int32_t>(other));
            }
        }
    }
    std::sort(neighbours.begin(), neighbours.end());
}

/// Adds to the row of control c what the tet of one entry of of_tet brings.
void add_row(const Stiffness &k, const Elements &elements, std::size_t entry,
             const std::vector<std::int64_t> &slot_of, double *out) {
    const std::size_t tet = entry / k.controls;
    const std::size_t a = entry % k.controls;
    const Couplings g = couplings(elements.gradients + 12 * tet, elements.volumes[tet],
                                  elements.lambda[tet], elements.mu[tet]);
    const std::int64_t *controls = elements.of_tet + tet * k.controls;
    for (std::size_t b = 0; b < k.controls; ++b) {
        const Block part = block(k, g, a, b);
        const auto slot = slot_of[static_cast<std::size_t>(controls[b])];
        double *sum = out + 9 * static_cast<std::size_t>(slot);
        for (std::size_t e = 0; e < 9; ++e)
            sum[e] += part[e];
    }
}

/// Runs work(row, thread) for all rows, `piece` of them at a time.
template <class Work>
void each_row(Team &team, std::size_t rows, std::size_t piece, const Work &work) {
    team.run((rows + piece - 1) / piece, [&](std::size_t p, std::size_t thread) {
        for (std::size_t row = p * piece; row < std::min((p + 1) * piece, rows); ++row)
            work(row, thread);
    });
}

} // namespace

Pattern pattern(const std::int64_t *of_tet, std::size_t tets, std::size_t per_tet,
                std::size_t controls, Team &team) {
    const Incidence in = incidence(of_tet, tets, per_tet, controls, team);
    Pattern where{std::vector<std::int64_t>(controls + 1, 0), {}};
    std::vector<std::int32_t> seen_by(controls, -1);
    std::vector<std::int32_t> neighbours;
    in_turn(team, controls, [&](std::size_t c) {
        neighbours_of(c, in, of_tet, per_tet, seen_by, neighbours);
        where.column.insert(where.column.end(), neighbours.begin(), neighbours.end());
        where.start[c + 1] = static_cast<std::int64_t>(where.column.size());
    });
    return where;
}

// The sum over elements in the paper, eq. 32.
void assemble(const Stiffness &k, const Elements &elements, const Rows &where, Team &team,
              double *out) {
    const Incidence in = incidence(elements.of_tet, elements.tets, k.controls, where.rows, team);
    std::vector<std::vector<std::int64_t>> slots(team.size());
    std::fill(out, out + 9 * where.start[where.rows], 0.0);
    each_row(team, where.rows, rows_assembled, [&](std::size_t c, std::size_t thread) {
        auto &slot_of = slots[thread];
        slot_of.resize(where.rows);
        for (auto s = where.start[c]; s < where.start[c + 1]; ++s)
            slot_of[static_cast<std::size_t>(where.column[s])] = s;
        for (auto e = in.start[c]; e < in.start[c + 1]; ++e)
            add_row(k, elements, static_cast<std::size_t>(in.entry[static_cast<std::size_t>(e)]),
                    slot_of, out);
    });
}

void multiply(const Rows &where, const double *blocks, const double *x, Team &team, double *y) {
    each_row(team, where.rows, rows_multiplied, [=](std::size_t row, std::size_t) {
        double y0 = 0, y1 = 0, y2 = 0;
        for (auto s = where.start[row]; s < where.start[row + 1]; ++s) {
            const double *b = blocks + 9 * s;
            const double *v = x + 3 * static_cast<std::ptrdiff_t>(where.column[s]);
            y0 += b[0] * v[0] + b[1] * v[1] + b[2] * v[2];
            y1 += b[3] * v[0] + b[4] * v[1] + b[5] * v[2];
            y2 += b[6] * v[0] + b[7] * v[1] + b[8] * v[2];
        }
        y[3 * row] = y0;
        y[3 * row + 1] = y1;
        y[3 * row + 2] = y2;
    });
}

} // namespace bezsoma
