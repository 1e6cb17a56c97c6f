// The population that the machines of a fleet come from: the lines of [population], estimated from
// all of them together.
//
//   const PopulationFit fit(mill, model, campaigns);   // model: of campaign.h
//   fit.statements();                                  // file against fleet, one for each line
//   fit.theta();                                       // for PopulationEvidence
//
// phi, the logarithms of the lines against those of the machine file, is what the machines have in
// common: each has X phi + delta_i, X from lines to functions, delta_i normal with 0.4 for sizes
// and
// 0.25 for lengths (so no machine and no function settles a line for all others). With score g_i
// and information F_i of log Z_i (fusion/population_evidence.h) at X phi it solves, by Newton's
// steps,
//
//   sum over the machines of X' W_i g_i = phi / s^2         W_i = diag 1 / (1 + F_ii var delta)
//
// s = 1.5 (a factor of 4.5). The sum is in the order of the machines; of each the first campaign
// counts, since its errors are drawn once however often they are measured.
// Frames: none. Units: SI. Shapes: phi one value for each fusion::Line.
// Failure: InputError for no machine.
// Source: Rasmussen and Williams (2006), 5.4; hierarchical models: Gelman and Hill (2007), 12.
// Validity: machines whose errors vary about zero; what all of a type have in common counts as
// their size.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fleet/campaign.h"
#include "machine/machine.h"

namespace abbe::fleet {

class PopulationFit {
 public:
  PopulationFit(const machine::Machine& machine, const machine::VolumetricModel& model,
                const std::vector<Campaign>& campaigns);

  // In the order of the campaigns, each once.
  const std::vector<std::string>& machines() const { return machines_; }
  // The first campaign of each.
  const std::vector<fusion::Quadratic>& seen() const { return seen_; }
  const fusion::PopulationEvidence& evidence() const { return evidence_; }
  const machine::VolumetricModel& model() const { return model_; }

  const std::vector<fusion::Statement>& statements() const { return statements_; }
  // One value for each knob of the evidence.
  Eigen::VectorXd theta() const { return lines_ * phi_; }
  // Estimated without one machine, by one step.
  Eigen::VectorXd ThetaWithout(std::size_t machine) const;

 private:
  struct Sums {
    Eigen::VectorXd score;                // of phi
    Eigen::MatrixXd information;          // the same
    std::vector<Eigen::VectorXd> scores;  // of each machine
    std::vector<Eigen::MatrixXd> informations;
  };
  static double OffOf(const Sums& at);
  Sums SumsAt(const Eigen::VectorXd& phi) const;
  void Solve();

  const machine::VolumetricModel& model_;
  const fusion::PopulationEvidence evidence_;
  std::vector<std::string> machines_;
  std::vector<fusion::Quadratic> seen_;
  Eigen::MatrixXd lines_;  // X
  Eigen::VectorXd phi_;
  Sums at_;
  std::vector<fusion::Statement> statements_;
};

}  // namespace abbe::fleet
