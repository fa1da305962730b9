// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The report of a study of two methods as a document.

#include <string>
#include <vector>

#include "analysis/blocks.h"
#include "analysis/report.h"

namespace pinchlab::analysis {

Document make_document(const Report& report, const AnswersTable& table);

// Its parts that have files of their own.
/// Side, order, time and attention.
std::vector<Block> effect_blocks(const Report& report);
/// What there is to say of graded preferences; nothing where there are none.
std::vector<Block> graded_blocks(const Report& report);
/// What went in, what participants wrote, and the methods.
std::vector<Block> input_blocks(const Report& report, const AnswersTable& table);

/// Why an estimate is not given; nothing where it is.
std::vector<Block> why_missing(const std::string& what, const Estimate& estimate);

}  // namespace pinchlab::analysis
