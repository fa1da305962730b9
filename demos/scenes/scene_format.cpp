// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/scene_format.h"

#include "sim/outline.h"
#include "sim/scene_checks.h"

namespace pinchlab {
namespace {

using enum KeyType;
constexpr bool required = true, optional = false;

// The limits are far outside of what a scene can mean and well inside of what doubles can hold.
const ObjectFormat body_look_format = {
    "body_look",
    {{"colour", colour, optional},
     {"label", text, optional, 0, 40},
     {"label_side", choice, optional, 0, 0, {"automatic", "below", "above", "left", "right"}},
     {"marks", boolean, optional}}};

const ObjectFormat cable_look_format = {
    "cable_look", {{"colour", colour, optional}, {"marks", boolean, optional}}};

const ObjectFormat motor_point_format = {"motor_point",
                                         {{"time_s", number, required, 0, 3600},
                                          {"angular_velocity_rad_s", number, optional, -1e5, 1e5},
                                          {"torque_n_m", number, optional, -1e12, 1e12}}};

const ObjectFormat shape_format = {"shape",
                                   {{"radius_m", number, optional, 1e-6, 1e4},
                                    {"corners_m", points, optional, 3, most_corners},
                                    {"corner_radius_m", number, optional, 0, 1e4},
                                    {"at_m", vector, optional, -1e4, 1e4},
                                    {"angle_rad", number, optional, -1e6, 1e6},
                                    {"cable_friction", friction, optional, 0, 100},
                                    {"contact_friction", number, optional, 0, 100},
                                    {"restitution", number, optional, 0, 1}}};

const ObjectFormat body_format = {
    "body",
    {{"name", name, required, 1, 64},
     {"kind", choice, required, 0, 0, {"free", "rail", "fixed_axle", "fixed"}},
     {"radius_m", number, optional, 1e-6, 1e4},
     {"corners_m", points, optional, 3, most_corners},
     {"corner_radius_m", number, optional, 0, 1e4},
     {"shapes", list, optional, 1, 32, {}, &shape_format},
     {"mass_kg", number, optional, lightest_body, heaviest_body},
     {"density_kg_m2", number, optional, 1e-12, 1e12},
     {"inertia_kg_m2", number, optional, 1e-18, 1e20},
     {"position_m", vector, required, -1e6, 1e6},
     {"angle_rad", number, optional, -1e6, 1e6},
     {"velocity_m_s", vector, optional, -1e5, 1e5},
     {"angular_velocity_rad_s", number, optional, -1e5, 1e5},
     {"rail_axis", vector, optional, -1e6, 1e6},
     {"travel_m", vector, optional, -1e6, 1e6},
     {"driven_angular_velocity_rad_s", number, optional, -1e5, 1e5},
     {"torque_n_m", number, optional, -1e12, 1e12},
     {"motor", list, optional, 1, 1'000, {}, &motor_point_format},
     {"torque_limit_n_m", number, optional, 1e-12, 1e12},
     {"linear_drag_per_s", number, optional, 0, 1e4},
     {"angular_drag_per_s", number, optional, 0, 1e4},
     {"cable_friction", friction, optional, 0, 100},
     {"contact_friction", number, optional, 0, 100},
     {"restitution", number, optional, 0, 1},
     {"look", object, optional, 0, 0, {}, &body_look_format}}};

const ObjectFormat attachment_format = {"attachment",
                                        {{"world_m", vector, optional, -1e6, 1e6},
                                         {"body", name, optional, 1, 64},
                                         {"point_m", vector, optional, -1e4, 1e4},
                                         {"rim_angle_rad", number, optional, -1e6, 1e6},
                                         {"layers", boolean, optional}}};

const ObjectFormat wrap_format = {
    "wrap",
    {{"body", name, required, 1, 64},
     {"turn", choice, required, 0, 0, {"counter_clockwise", "clockwise"}},
     {"extra_turns", integer, optional, 0, most_extra_turns}}};

const ObjectFormat cable_format = {"cable",
                                   {{"name", name, required, 1, 64},
                                    {"half_width_m", number, required, 1e-6, 1e3},
                                    {"closed", boolean, optional},
                                    {"start", object, optional, 0, 0, {}, &attachment_format},
                                    {"end", object, optional, 0, 0, {}, &attachment_format},
                                    {"wraps", list, optional, 0, 10'000, {}, &wrap_format},
                                    {"slack_m", number, optional, -1e6, 1e6},
                                    {"axial_stiffness_n", number, optional, 1e-3, 1e15},
                                    {"creep", boolean, optional},
                                    {"squeeze", number, optional, 0, 1},
                                    {"grip", number, optional, 0, 1},
                                    {"mass_per_metre_kg", number, optional, 1e-9, 1e9},
                                    {"nodes", integer_or_word, optional, 1, 1000, {"automatic"}},
                                    {"node_tolerance_m", number, optional, 1e-6, 1e3},
                                    {"bending_stiffness_n_m2", number, optional, 0, 1e9},
                                    {"contact_friction", number, optional, 0, 100},
                                    {"linear_drag_per_s", number, optional, 0, 1e4},
                                    {"look", object, optional, 0, 0, {}, &cable_look_format}}};

const ObjectFormat joint_look_format = {"joint_look", {{"colour", colour, optional}}};

const ObjectFormat joint_end_format = {"joint_end",
                                       {{"world_m", vector, optional, -1e6, 1e6},
                                        {"body", name, optional, 1, 64},
                                        {"point_m", vector, optional, -1e4, 1e4}}};

const ObjectFormat joint_format = {
    "joint",
    {{"name", name, required, 1, 64},
     {"kind", choice, required, 0, 0, {"distance", "hinge", "spring"}},
     {"start", object, optional, 0, 0, {}, &joint_end_format},
     {"end", object, optional, 0, 0, {}, &joint_end_format},
     {"body", name, optional, 1, 64},
     {"other", name, optional, 1, 64},
     {"at_m", vector, optional, -1e6, 1e6},
     {"stiffness_n_m", number, optional, 1e-6, 1e15},
     {"natural_length_m", number, optional, 1e-6, 1e6},
     {"damping_n_s_m", number, optional, 0, 1e12},
     {"look", object, optional, 0, 0, {}, &joint_look_format}}};

const ObjectFormat wall_format = {"wall",
                                  {{"from_m", vector, required, -1e6, 1e6},
                                   {"to_m", vector, required, -1e6, 1e6},
                                   {"contact_friction", number, optional, 0, 100},
                                   {"restitution", number, optional, 0, 1}}};

const ObjectFormat view_format = {
    "view", {{"low_m", vector, required, -1e6, 1e6}, {"high_m", vector, required, -1e6, 1e6}}};

const ObjectFormat baseline_format = {
    "baseline",
    {{"method", choice, required, 0, 0, {"pinch_no_contact", "cable"}},
     {"reason", text, required, 1, 1000}}};

const ObjectFormat file_format = {"scene",
                                  {{"$schema", text, optional, 1, 1000},
                                   {"title", text, required, 1, 80},
                                   {"notes", text, optional, 1, 4000},
                                   {"gravity_m_s2", vector, optional, -1e4, 1e4},
                                   {"bodies", list, required, 1, 10'000, {}, &body_format},
                                   {"cables", list, optional, 0, 1'000, {}, &cable_format},
                                   {"joints", list, optional, 0, 1'000, {}, &joint_format},
                                   {"walls", list, optional, 0, 1'000, {}, &wall_format},
                                   {"duration_s", number, required, 1e-3, 3600},
                                   {"frames_per_second", integer, optional, 1, 1000},
                                   {"steps_per_frame", integer, optional, 1, 1000},
                                   {"error_m", number, optional, 0, 1},
                                   {"poster_time_s", number, optional, 0, 3600},
                                   {"view", object_or_word, required, 0, 0, {"fit"}, &view_format},
                                   {"baseline", object, required, 0, 0, {}, &baseline_format}}};

const ObjectFormat colours_format = {"theme",
                                     {{"$schema", text, optional, 1, 1000},
                                      {"notes", text, optional, 1, 4000},
                                      {"background", colour, optional},
                                      {"ink", colour, optional},
                                      {"rail", colour, optional},
                                      {"support", colour, optional},
                                      {"cable", colour, optional},
                                      {"cable_edge", colour, optional},
                                      {"cable_mark", colour, optional},
                                      {"body", colour, optional},
                                      {"body_edge", colour, optional},
                                      {"driven", colour, optional},
                                      {"driven_edge", colour, optional},
                                      {"fixed", colour, optional},
                                      {"fixed_edge", colour, optional},
                                      {"shadow", colour, optional},
                                      {"line_width", number, optional, 0.1, 10},
                                      {"text_height", number, optional, 0.5, 20}}};

}  // namespace

const ObjectFormat& theme_format() {
  return colours_format;
}

const ObjectFormat& scene_format() {
  return file_format;
}

}  // namespace pinchlab
