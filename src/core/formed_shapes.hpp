// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace bezsoma {

/// Whether tets' shapes are formed from their points at each product, in place of being kept: at
/// degree 1 they would be most of what an operator keeps and reads. float32 has too few digits.
/// `Batches::geometry` then is where the chunk's own points (controls, 3) begin; its foreign ones
/// end there, so that a run's place, below zero for a foreign one, leads to either.
template <class T> constexpr bool forms_shapes(int degree) { return degree == 1 && sizeof(T) == 8; }

} // namespace bezsoma
