// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An order of the rows in which the solver's matrix is narrow.

namespace pinchlab {

struct OrderScratch;
struct PartSystem;

/// Orders the rows of a part by reverse Cuthill-McKee (1969), so that coupled rows come close
/// together: along a cable, one after the other. The order is kept while the part's rows couple the
/// same bodies as in the last step.
void order_rows(PartSystem& system, OrderScratch& scratch);

}  // namespace pinchlab
