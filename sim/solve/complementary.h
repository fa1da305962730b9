// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// All states of a part at once, where guesses of them go round in circles.
//
// In the plane Coulomb's law and the capstan's are linear complementarity conditions, and so are
// those of what pulls or pushes. With impulses p, w = J v + bias of the rows, and sliding speeds
// sigma = sigma+ - sigma-, all of them >= 0 and each pair's product 0:
//     p                      and  w   of segments and normals; of the segment before a run
//                                 w - sigma, of that after it w + sigma, of what presses w + sigma
//     beta+, beta-           and  lambda + w, lambda - w,    p = beta+ - beta- of friction,
//     lambda                 and  mu N - beta+ - beta-
//     sigma+                 and  limit+ - T_out,            a run's, T_out the impulse after it,
//     sigma-                 and  T_out - limit-,            limits by passages from that before
//     sigma+                 and  p + f+,  sigma- and  -p - f-, of a sleeve's friction p where
//                                 w = sigma (rubbing.h),
// with limit+ = k T_in + mu N - p_middle and so on (capstan.h). Of elastic cable that may slide p
// and w are those of its tensions at the interval's end, from which sliding speeds follow
// (elastic.h): the states are of these, and so are impulses where those of the kick's means
// contradict them. For z >= 0 the matrix has
//     z' M z = p' J M^-1 J' p + lambda mu N + sigma+ (k - 1) T_in + ...  >= 0
// where no middle body that rubs comes before an arc: it is copositive, and Lemke's method finds a
// solution if velocities are that all conditions allow (lemke.h). Of many unknowns doubles mostly
// find what bears force in it. Its values are found in extended numbers, and so is what bears where
// doubles find nothing that holds, or impulses that all but cancel one another: of a body in a span
// that bends by 1e-7 they do not tell that the span holds it, and of impulses that are ten million
// times what they come to velocities lose half of their digits.

namespace pinchlab {

struct PartSystem;
struct SolveScratch;

/// Finds a solution: impulses, velocities, states and sliding speeds. Whether it has; conditions
/// hold to within the part's reach in a step, but for such as contradict one another, which yield
/// (SolveScratch::left_out). Round-off of positions is left as it is (the rows' biases are without
/// it then). What bears force both ways, or is without a bound, or is a sleeve's friction, does so
/// if it is on, as it is now. Two laws are no part of this: that of cable which is pushed on to an
/// arc, and that of a rope which presses its rim one way and not the other.
bool solve_complementary(PartSystem& system, SolveScratch& scratch);

/// The solution found last once more, after another solve of the same rows.
void take_complementary(PartSystem& system, SolveScratch& scratch);

}  // namespace pinchlab
