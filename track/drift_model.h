// How the parameters of a map change: the covariance of their walk, and the shapes in which they
// follow a temperature.
//
//   const Eigen::MatrixXd walked = WalkRoot(mill, map.model(), *drift.walk);  // of a day
//   const Response response = ResponseOf("table", map.model(), by_kelvin);
//   parameters += response.shapes * gains * kelvin;
//
// Walk: each function goes on as a Gaussian process with the sizes and the smoothness stated, the
// prior of fusion/machine_prior.h; a squareness and a scale as a number. Response: with s from 0 to
// 1 over the travel, a positioning error follows a warmer sensor by g1 s + g2 s^2, an angle too, a
// straightness by g1 s^2 + g2 s^3 (its slope is squareness), a squareness by g. All gains are
// independent; the standard deviation of g1 of a positioning error is the growth over the travel.
// Units: SI for each kelvin, SI after a day. Shapes: root P x P; shapes P x m, deviations m.
// Failure: InputError for functions that are no quintic B-splines, which abbe fuse makes.
// Source: own; growth and bending of beams for the shapes.
// Validity: shapes of higher order are taken for walk.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "machine/machine.h"
#include "machine/volumetric_model.h"

namespace abbe::track {

Eigen::MatrixXd WalkRoot(const machine::Machine& machine, const machine::VolumetricModel& model,
                         const machine::Population& walk);

struct Response {
  std::vector<std::string> names;  // "response table EXX.linear"
  Eigen::MatrixXd shapes;
  Eigen::VectorXd deviations;  // of the gains before anything is known of them
};

Response ResponseOf(const std::string& sensor, const machine::VolumetricModel& model,
                    const machine::Population& by_kelvin);

}  // namespace abbe::track
