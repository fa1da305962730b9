// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/circumstances.h"

#include <fmt/format.h>

#include <algorithm>

namespace pinchlab::analysis {
namespace {

using nlohmann::ordered_json;

std::string screens_text(const Circumstances& all) {
  std::vector<std::pair<std::pair<int, int>, int>> sizes(all.screens.begin(), all.screens.end());
  std::ranges::stable_sort(sizes, std::greater<>(), [](const auto& size) { return size.second; });
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, sizes.size()); ++i) {
    const auto& [size, people] = sizes[i];
    text += fmt::format("{}{} of {} × {}", i == 0 ? "" : ", ", people, size.first, size.second);
  }
  if (sizes.size() > most) text += fmt::format(" and {} other sizes", sizes.size() - most);
  return text;
}

std::string playback_text(const Circumstances& all) {
  std::string text = fmt::format("Playback: {} dropped frames", all.dropped_frames);
  if (all.frames > 0) {
    text += fmt::format(
        " of {} ({:.2f} %)", all.frames,
        100.0 * static_cast<double>(all.dropped_frames) / static_cast<double>(all.frames));
  }
  text += fmt::format(", {} losses of focus, {} playback errors", all.focus_lost_count,
                      all.playback_errors);
  if (!all.errors_for.empty()) text += fmt::format(" ({})", fmt::join(all.errors_for, ", "));
  return text + ".";
}

// Widens a range of widths, which is 0 while there is none, by another.
void widen(int& narrowest, int& widest, int other_narrowest, int other_widest) {
  if (other_narrowest <= 0) return;
  narrowest = narrowest == 0 ? other_narrowest : std::min(narrowest, other_narrowest);
  widest = std::max(widest, other_widest);
}

}  // namespace

void note(const AnswerFile& file, Session& session) {
  for (const Trial& trial : file.trials) {
    if (trial.kind == TrialKind::attention) {
      ++(trial.choice == trial.expected ? session.attention_passed : session.attention_failed);
    }
    session.focus_lost_count += trial.focus_lost_count;
    session.frames += trial.frame_count;
    session.dropped_frames += trial.dropped_frames;
    session.playback_errors += trial.playback_errors;
    if (trial.screen_width_px > 0) {
      session.screen_width_px = trial.screen_width_px;
      session.screen_height_px = trial.screen_height_px;
    }
    widen(session.narrowest_clips_px, session.widest_clips_px, trial.clip_width_px,
          trial.clip_width_px);
  }
  session.refresh_rate_hz = file.refresh_rate_hz;
  session.free_text = file.free_text;
}

NamedSessions named_sessions(const AnswersTable& table) {
  NamedSessions named;
  for (const auto& [participant, session] : table.sessions) {
    named.emplace(table.participants[participant], session);
  }
  return named;
}

Circumstances circumstances(const NamedSessions& sessions, bool recorded) {
  Circumstances all;
  all.recorded = recorded;
  for (const auto& [participant, session] : sessions) {
    all.checks_passed += session.attention_passed;
    all.checks_failed += session.attention_failed;
    if (session.attention_failed > 0) all.failed_by.push_back(participant);
    all.focus_lost_count += session.focus_lost_count;
    all.frames += session.frames;
    all.dropped_frames += session.dropped_frames;
    all.playback_errors += session.playback_errors;
    if (session.playback_errors > 0) all.errors_for.push_back(participant);
    if (session.screen_width_px > 0) {
      ++all.screens[{session.screen_width_px, session.screen_height_px}];
    }
    widen(all.narrowest_clips_px, all.widest_clips_px, session.narrowest_clips_px,
          session.widest_clips_px);
    if (session.refresh_rate_hz <= 0) continue;
    ++all.screens_measured;
    if (shows_60_evenly(session.refresh_rate_hz)) continue;
    all.uneven_screens.push_back(
        fmt::format("{} ({:.0f} Hz)", participant, session.refresh_rate_hz));
  }
  return all;
}

std::vector<Block> circumstance_blocks(const Circumstances& all) {
  std::vector<Block> blocks;
  if (all.checks_passed + all.checks_failed > 0) {
    std::string text = fmt::format("Attention checks: {} passed, {} failed.", all.checks_passed,
                                   all.checks_failed);
    if (all.checks_failed > 0) {
      text += fmt::format(
          " Failed by {}; their answers are in the figures above unless they are left out with "
          "--exclude.",
          fmt::join(all.failed_by, ", "));
    }
    blocks.emplace_back(Paragraph{text});
  }
  if (!all.recorded) return blocks;
  blocks.emplace_back(Paragraph{playback_text(all)});
  if (!all.screens.empty()) {
    std::string text = fmt::format("Screens, in CSS pixels: {}.", screens_text(all));
    if (all.widest_clips_px > 0) {
      const bool is_same = all.narrowest_clips_px == all.widest_clips_px;
      text += is_same ? fmt::format(" Both clips together were {} wide.", all.widest_clips_px)
                      : fmt::format(" Both clips together were {} to {} wide.",
                                    all.narrowest_clips_px, all.widest_clips_px);
    }
    blocks.emplace_back(Paragraph{text});
  }
  if (all.screens_measured > 0) {
    blocks.emplace_back(Paragraph{
        fmt::format("{} of {} measured screens do not show 60 frames a second evenly{}{}.",
                    all.uneven_screens.size(), all.screens_measured,
                    all.uneven_screens.empty() ? "" : ": ", fmt::join(all.uneven_screens, ", "))});
  }
  return blocks;
}

void put_circumstances(ordered_json& document, const Circumstances& all) {
  document["attention_checks"] = {
      {"passed", all.checks_passed}, {"failed", all.checks_failed}, {"failed_by", all.failed_by}};
  ordered_json playback = {{"recorded", all.recorded},
                           {"focus_lost_count", all.focus_lost_count},
                           {"frames", all.frames},
                           {"dropped_frames", all.dropped_frames},
                           {"playback_errors", all.playback_errors},
                           {"errors_for", all.errors_for}};
  ordered_json screens = ordered_json::array();
  for (const auto& [size, people] : all.screens) {
    screens.push_back(
        {{"width_px", size.first}, {"height_px", size.second}, {"participants", people}});
  }
  if (!screens.empty()) playback["screens"] = screens;
  if (all.widest_clips_px > 0) {
    playback["narrowest_clips_px"] = all.narrowest_clips_px;
    playback["widest_clips_px"] = all.widest_clips_px;
  }
  if (all.screens_measured > 0) {
    playback["screens_measured"] = all.screens_measured;
    playback["uneven_screens"] = all.uneven_screens;
  }
  document["playback"] = playback;
}

}  // namespace pinchlab::analysis
