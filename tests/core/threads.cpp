// SPDX-License-Identifier: BSD-3-Clause
// The threaded core without Python, for sanitizers that a whole interpreter would drown in noise:
// operators, preconditioner and conjugate gradients on a block, by one thread and by four. The
// answers have to have the same bits. Built and run by .ci/run; prints what it did.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <thread>
#include <vector>

#include "aggregation.hpp"
#include "chunks.hpp"
#include "conjugate_gradients.hpp"
#include "elastic_operator.hpp"
#include "kernels.hpp"
#include "preconditioner.hpp"
#include "row_kernels.hpp"
#include "tet_controls.hpp"
#include "vertex_matrix.hpp"

namespace {

using namespace bezsoma;
using Point = std::array<double, 3>;

/// Six Kuhn tets in each cell of a cube, numbered as a walk over them meets their entities.
struct Mesh {
    int degree;
    std::vector<std::array<int, 4>> tets; // ascending vertices
    std::vector<Point> points;
    std::vector<std::int32_t> first, corners;
    std::vector<std::int64_t> order, region, vertices; // the last: tets in one run
    std::vector<double> lame{1.0, 0.7, 300.0, 40.0};
    std::vector<Point> points_met; // in the order of the degree-1 controls
    std::vector<std::uint8_t> fixed, fixed_vertices;

    Mesh(int degree, int cells) : degree(degree) {
        const int side = cells + 1;
        for (int v = 0; v < side * side * side; ++v)
            points.push_back({v / (side * side) + 0.1 * (v % 3), v / side % side + 0.07 * (v % 5),
                              v % side + 0.05 * (v % 2)});
        const int step[3] = {side * side, side, 1};
        for (int c = 0; c < cells * cells * cells; ++c) {
            int axes[3] = {0, 1, 2};
            const int corner =
                c / (cells * cells) * step[0] + c / cells % cells * step[1] + c % cells;
            do {
                std::array<int, 4> tet{corner};
                for (int i = 0; i < 3; ++i)
                    tet[i + 1] = tet[i] + step[axes[i]];
                tets.push_back(tet);
            } while (std::next_permutation(axes, axes + 3));
        }
        for (std::size_t t = 0; t < tets.size(); ++t) {
            vertices.insert(vertices.end(), tets[t].begin(), tets[t].end());
            order.push_back(static_cast<std::int64_t>(t));
            region.push_back(static_cast<std::int64_t>(t / 7 % 2));
        }
        number(side);
    }

    /// Controls by entity in first-touch order, those on the lower side fixed.
    void number(int side) {
        std::map<std::vector<int>, std::int32_t> met, met_vertices;
        std::int32_t next = 0;
        for (const auto &tet : tets)
            for (int e = 0; e < entities_of_tet(degree); ++e) {
                std::vector<int> own;
                for (int v = 0; v < 4; ++v)
                    if (entity_vertices[e] >> v & 1)
                        own.push_back(tet[v]);
                const bool low = std::ranges::all_of(own, [=](int v) { return v % side == 0; });
                const auto [at, is_new] = met.try_emplace(own, next);
                first.push_back(at->second);
                if (is_new) {
                    next += controls_inside(degree, e);
                    fixed.resize(3 * static_cast<std::size_t>(next), low);
                }
                if (e < 4) {
                    const auto number = static_cast<std::int32_t>(met_vertices.size());
                    const auto [vertex, unseen] = met_vertices.try_emplace(own, number);
                    corners.push_back(vertex->second);
                    if (unseen) {
                        points_met.push_back(points[own[0]]);
                        fixed_vertices.resize(fixed_vertices.size() + 3, low);
                    }
                }
            }
    }

    ElasticTets view() const {
        return {degree,
                static_cast<std::int64_t>(tets.size()),
                first.data(),
                order.data(),
                points.front().data(),
                vertices.data(),
                region.data(),
                lame.data(),
                2};
    }
};

struct Answer {
    std::vector<double> forces, x;
    std::vector<float> single;
    Convergence found;
};

template <class T> std::vector<T> vector_of(std::size_t length) {
    std::vector<T> u(length);
    for (std::size_t i = 0; i < length; ++i)
        u[i] = static_cast<T>(std::sin(1.0 + 0.37 * static_cast<double>(i)));
    return u;
}

Answer answer(const Mesh &mesh, const Kernels &kernels, std::size_t threads) {
    Team team(threads);
    int polled = 0;
    team.watch([&] { ++polled; });
    const ElasticTets tets = mesh.view();
    ElasticOperator<double> k(tets, kernels, team);
    ElasticOperator<float> single(tets, kernels, team);
    const std::size_t length = 3 * static_cast<std::size_t>(k.controls());
    Answer result;
    for (int sides : {1, 3, 13, 8, 2, 1}) {
        const auto u = vector_of<double>(length * static_cast<std::size_t>(sides));
        std::vector<double> f(u.size());
        k.apply(u.data(), f.data(), sides);
        result.forces.insert(result.forces.end(), f.begin(), f.end());
    }
    const auto u = vector_of<float>(length);
    result.single.resize(length);
    single.apply(u.data(), result.single.data());

    const auto vertices = static_cast<std::int64_t>(mesh.points_met.size());
    std::unique_ptr<Preconditioner> blocks;
    if (mesh.degree > 1)
        blocks = std::make_unique<Preconditioner>(tets, mesh.corners.data(), vertices,
                                                  mesh.fixed.data(), k.chunks(), kernels, team);
    Aggregation aggregation(
        vertex_matrix(tets, mesh.corners.data(), vertices, mesh.fixed_vertices.data(), team),
        mesh.points_met.front().data(), mesh.fixed_vertices.data(), *kernels.rows, team);
    auto f = vector_of<double>(length);
    double size = 0;
    for (std::size_t i = 0; i < length; ++i)
        size += mesh.fixed[i] ? 0.0 : f[i] * f[i];
    result.x.assign(length, 0.0);
    const auto vertex_solver = [&](const float *r, float *z) { aggregation.apply(r, z); };
    result.found =
        conjugate_gradients(k, {blocks.get(), vertex_solver, team}, mesh.fixed.data(), f.data(),
                            result.x.data(), std::sqrt(size), 1e-8, 500, team, [](int, double) {});
    return result;
}

/// What a user's Ctrl-C does: the watch throws between two jobs, and the team is as before.
bool survives_a_stop(const Mesh &mesh, const Kernels &kernels) {
    Team team(4);
    ElasticOperator<double> k(mesh.view(), kernels, team);
    const auto u = vector_of<double>(3 * static_cast<std::size_t>(k.controls()));
    std::vector<double> f(u.size()), again(u.size());
    k.apply(u.data(), f.data());
    bool stop = true, stopped = false;
    team.watch([&] {
        if (stop)
            throw std::runtime_error("stop");
    });
    for (int i = 0; i < 1000 && !stopped; ++i)
        try {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            k.apply(u.data(), again.data());
        } catch (const std::runtime_error &) {
            stopped = true;
        }
    stop = false;
    k.apply(u.data(), again.data());
    return stopped && f == again;
}

/// What pieces throw in several threads at once comes back as one error, and the team as before.
bool hands_errors_back() {
    Team team(4);
    std::vector<int> done(500);
    int caught = 0;
    for (int round = 0; round < 50; ++round) {
        try {
            team.run(done.size(), [&](std::size_t piece, std::size_t) {
                if (piece % 7 == 3)
                    throw std::bad_alloc();
                ++done[piece];
            });
        } catch (const std::bad_alloc &) {
            ++caught;
        }
        std::ranges::fill(done, 0);
        team.run(done.size(), [&](std::size_t piece, std::size_t) { ++done[piece]; });
        if (!std::ranges::all_of(done, [](int times) { return times == 1; }))
            return false;
    }
    return caught == 50;
}

} // namespace

int main(int count, char **names) {
    if (!hands_errors_back()) {
        std::printf("a team lost an error, or was lost with it\n");
        return 1;
    }
    for (int which = 1; which < count; ++which) {
        const Kernels *kernels = kernels_named(names[which]);
        if (!kernels) {
            std::printf("%s: not on this machine\n", names[which]);
            continue;
        }
        // Up to the highest degree that this build has (BEZSOMA_HIGHEST_DEGREE), or 5.
        for (int degree = 1; degree <= 5 && kernels->f64[degree - 1].apply; ++degree) {
            // At degree 1 large enough that A P comes in several slabs (galerkin.cpp).
            const Mesh mesh(degree, degree == 1 ? 17 : degree == 2 ? 8 : 5);
            const Answer one = answer(mesh, *kernels, 1), four = answer(mesh, *kernels, 4);
            const bool same = one.forces == four.forces && one.single == four.single &&
                              one.x == four.x && one.found.history == four.found.history;
            std::printf("%s, degree %d: %zu unknowns, %zu iterations, %s, %s\n", names[which],
                        degree, one.x.size(), one.found.history.size() - 1,
                        one.found.converged ? "converged" : "NOT CONVERGED",
                        same ? "same bits" : "OTHER BITS");
            if (!same || !one.found.converged)
                return 1;
        }
        if (!survives_a_stop(Mesh(2, 8), *kernels)) {
            std::printf("%s: a stop left something behind\n", names[which]);
            return 1;
        }
    }
}
