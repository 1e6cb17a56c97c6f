// Three error models of the linkage on named parameter blocks.
//
// PivotErrorModel (the RELM paper, figure 4), two links and three pivots:
//   Rx(tilt x) Ry(tilt y) Rz(q1 + o1) Rx(twist of pivot 2) T(divergence x, y, 0) Ry(q2 + o2)
//   Tx(L1) Rx(twist of link 1) Ry(q3 + o3) Tz(L2)
//   blocks  link: link_1 link_2 | tilt: pivot_1_x pivot_1_y | twist: pivot_2 link_1 |
//           divergence: pivot_2_x pivot_2_y | encoder_offset: pivot_1 pivot_2 pivot_3
//
// PublishedErrorModel (Boelens (2006)), the displacement equation of segments 0 ... S-1:
//   blocks  link: segment_1 ... | tilt: head_x head_y | radial_angle: pivot_1 ... segment_... |
//           bearing: pivot_1_sin_1 pivot_1_cos_1 pivot_1_sin_2 ... (with bearing only)
//   Six segments and three encoders have 5 + 2 + 5 = 12 of them, two harmonics add 12. Boelens
//   counts the twelve but does not list them. The five radial angles here are the angles of the
//   encoders and the twist of each later pivot about the longest segment before it; with them the
//   twelve are the eleven of the RELM paper and the offset of pivot 3.
//
// CompleteErrorModel, any chain of n joints, every small motion of every axis:
//   blocks  tilt: pivot_i_u pivot_i_v | shift: pivot_i_u pivot_i_v | ball: along across axial |
//           encoder_offset | eccentricity: pivot_i_sin pivot_i_cos | graduation |
//           bearing: pivot_i_u_sin_1 pivot_i_u_cos_1 ... pivot_i_v_sin_1 ... |
//           compliance | expansion: after_pivot_i
//   A tilt or a shift of an axis moves the axis and all that is mounted on it. The run-out of a
//   bearing shifts its axis in both directions across it, in the frame of the part that carries
//   the pivot. 4 parameters per joint and 3 of the ball describe every geometric error. An encoder
//   offset is a combination of these; it is a parameter because it has a tolerance of its own, and
//   the priors separate what the data cannot. u is the direction across the axis nearest to the
//   link that ends there, v = axis x u.
//
// Angles in rad, lengths in m. Link lengths have their nominal length as value, all other
// parameters are deviations from zero. Failure: InputError when the settings lack what a model
// needs (closed form, segments). Source: Boelens (2006), the RELM paper, docs/theory-linkage.md.
#pragma once

#include "relm/linkage_model.h"
#include "relm/linkage_settings.h"

namespace abbe::relm {

LinkageModel PivotErrorModel(const LinkageSettings& settings);
LinkageModel PublishedErrorModel(const LinkageSettings& settings, bool with_bearing);
LinkageModel CompleteErrorModel(const LinkageSettings& settings);

}  // namespace abbe::relm
