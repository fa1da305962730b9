// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/groups.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>

#include "base/csv_reader.h"
#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {

namespace {

// Opens a CSV file of exactly the two columns `first,second` and hands each checked row to `take`.
template <class Take>
void read_pairs(const std::filesystem::path& path, const std::string& first,
                const std::string& second, Take take) {
  CsvReader reader(path, ',');
  std::vector<std::string_view> fields;
  if (!reader.next(fields) || fields.size() != 2 || fields[0] != first || fields[1] != second) {
    throw InputError(fmt::format("{}:1", path.string()),
                     fmt::format("the first line must be `{},{}`", first, second));
  }
  while (reader.next(fields)) {
    if (fields.size() != 2) {
      throw InputError(reader.place(), fmt::format("{} fields instead of 2 (`{},{}`)",
                                                   fields.size(), first, second));
    }
    const std::string why = why_not_a_name(fields[0]);
    if (!why.empty()) throw InputError(reader.place(), fmt::format("bad {}: {}", first, why));
    take(fields[0], fields[1], reader.place());
  }
}

// Groups in the order of their names' first demonstration; `members` maps a name to indices.
std::vector<Group> make_groups(const std::map<std::string, std::set<std::uint16_t>>& members) {
  std::vector<Group> groups;
  groups.reserve(members.size());
  for (const auto& [name, indices] : members) {
    groups.push_back({name, {indices.begin(), indices.end()}});
  }
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) {
    return a.demonstrations.front() < b.demonstrations.front();
  });
  return groups;
}

void check_group_name(std::string_view name, const std::string& place) {
  const std::string why = why_not_a_name(name);
  if (!why.empty()) throw InputError(place, fmt::format("bad group: {}", why));
  if (name == all_group) {
    throw InputError(place,
                     "group `all` always exists and holds every demonstration; name another group");
  }
}

std::vector<Group> groups_of_file(const AnswersTable& table, const std::filesystem::path& path) {
  std::map<std::string, std::set<std::uint16_t>> members;
  read_pairs(path, "demonstration", "group",
             [&](std::string_view name, std::string_view group, const std::string& place) {
               check_group_name(group, place);
               const auto found =
                   std::find(table.demonstrations.begin(), table.demonstrations.end(), name);
               if (found == table.demonstrations.end()) {
                 throw InputError(place, fmt::format("no answers for demonstration `{}`{}", name,
                                                     did_you_mean(name, table.demonstrations)));
               }
               const auto index = static_cast<std::uint16_t>(found - table.demonstrations.begin());
               if (!members[std::string(group)].insert(index).second) {
                 throw InputError(place,
                                  fmt::format("`{}` is put into group `{}` twice", name, group));
               }
             });
  return make_groups(members);
}

// The number that a name begins with, or nothing.
std::optional<int> leading_number(const std::string& name) {
  size_t digits = 0;
  while (digits < name.size() && name[digits] >= '0' && name[digits] <= '9') ++digits;
  const auto number = parse_whole(std::string_view(name).substr(0, digits), 0, 9999);
  return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

// The default holds only where every name begins with its own number from 1 to 8: anything else is
// not the project's own set of demonstrations, and no group is guessed.
std::optional<std::vector<Group>> default_groups(const AnswersTable& table) {
  std::map<std::string, std::set<std::uint16_t>> members;
  std::set<int> seen;
  for (size_t i = 0; i < table.demonstrations.size(); ++i) {
    const std::optional<int> number = leading_number(table.demonstrations[i]);
    if (!number || *number < 1 || *number > 8 || !seen.insert(*number).second) return std::nullopt;
    members[*number <= 6 ? "clipping" : "friction"].insert(static_cast<std::uint16_t>(i));
  }
  return make_groups(members);
}

}  // namespace

void assign_groups(AnswersTable& table, const std::filesystem::path& groups_file,
                   const std::map<std::string, std::string>& column_groups) {
  if (!groups_file.empty()) {
    table.groups = groups_of_file(table, groups_file);
    table.groups_from = fmt::format("the file {}", groups_file.filename().string());
  } else if (!column_groups.empty()) {
    std::map<std::string, std::set<std::uint16_t>> members;
    for (size_t i = 0; i < table.demonstrations.size(); ++i) {
      const auto found = column_groups.find(table.demonstrations[i]);
      if (found == column_groups.end()) continue;
      members[found->second].insert(static_cast<std::uint16_t>(i));
    }
    table.groups = make_groups(members);
    table.groups_from = "the column `group` of the input";
  } else if (auto groups = default_groups(table)) {
    table.groups = std::move(*groups);
    table.groups_from = "the numbers that the names begin with (1 to 6 clipping, 7 and 8 friction)";
  } else {
    table.groups_from = "nothing but `all`, since neither --groups nor a column `group` says more";
  }
  Group all{all_group, std::vector<std::uint16_t>(table.demonstrations.size())};
  std::iota(all.demonstrations.begin(), all.demonstrations.end(), std::uint16_t{0});
  table.groups.push_back(std::move(all));
}

std::vector<Exclusion> read_exclusions(const std::filesystem::path& path) {
  std::vector<Exclusion> exclusions;
  std::set<std::string> seen;
  read_pairs(
      path, "participant", "reason",
      [&](std::string_view participant, std::string_view reason, const std::string& place) {
        if (reason.find_first_not_of(" \t") == std::string_view::npos) {
          throw InputError(
              place, fmt::format("no reason for leaving `{}` out; the report prints it, so say why",
                                 participant));
        }
        if (!seen.insert(std::string(participant)).second) {
          throw InputError(place, fmt::format("participant `{}` is listed twice", participant));
        }
        exclusions.push_back({std::string(participant), std::string(reason)});
      });
  return exclusions;
}

std::vector<Exclusion> exclusions_of(const ReadOptions& options) {
  std::vector<Exclusion> exclusions = options.by_rule;
  if (options.exclude_file.empty()) return exclusions;
  for (Exclusion& exclusion : read_exclusions(options.exclude_file)) {
    const bool is_new = std::ranges::find(options.by_rule, exclusion.participant,
                                          &Exclusion::participant) == options.by_rule.end();
    if (is_new) exclusions.push_back(std::move(exclusion));
  }
  return exclusions;
}

}  // namespace pinchlab::analysis
