// The population that the machines of a fleet come from: the lines of [population], estimated from
// all of them together.
//
//   const PopulationFit fit(mill, model, campaigns);   // model: of campaign.h
//   fit.statements();                                  // file against fleet, one for each line
//   fit.theta();                                       // for PopulationEvidence
//
// phi, the logarithms of the lines against those of the machine file, is what the machines have in
// common; the functions of machine i have X phi + D eta_i, X from lines to functions, D = 0.4 for
// sizes and 0.25 for lengths, so no machine and no function settles a line for all others. The mode of
//
//   sum_i (log Z_i(X phi + D eta_i) - eta_i' eta_i / 2) - phi' phi / (2 s^2)          s = 1.5
//
// is found by Newton's steps, the information F_i of log Z_i (fusion/population_evidence.h) in place
// of second derivatives and the eta_i eliminated; phi has then the information
//
//   sum_i X' (F_i - F_i D (1 + D F_i D)^-1 D F_i) X + 1 / s^2
//
// The sums are in the order of the machines; of each the first campaign counts, since its errors are
// drawn once however often they are measured.
// Frames: none. Units: SI. Shapes: phi one value for each fusion::Line.
// Failure: InputError for no machine.
// Source: Rasmussen and Williams (2006), 5.4; hierarchical models: Gelman and Hill (2007), 12; mode
// of all: Breslow and Clayton, J. Am. Stat. Assoc. 88 (1993).
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
  // The theta of a machine: its own lengths, sizes by all the others (to first order); and how a
  // machine scatters about that, squarenesses and slopes like functions.
  struct Expected {
    Eigen::VectorXd theta, spread;
  };
  Expected ExpectedWithout(std::size_t machine) const;

 private:
  // log Z and its slopes of one machine.
  struct OfMachine {
    double log;
    fusion::PopulationEvidence::Slopes slopes;
  };
  // What one machine adds to the normal equations of phi, its eta eliminated.
  struct Part {
    Eigen::VectorXd score;
    Eigen::MatrixXd information;
    Eigen::VectorXd eta_step;   // with phi as it is
    Eigen::MatrixXd eta_slope;  // by phi
  };
  struct State {
    Eigen::VectorXd phi;
    std::vector<Eigen::VectorXd> eta;
    std::vector<OfMachine> machines;
    double log = 0.0;  // of all
  };
  State At(Eigen::VectorXd phi, std::vector<Eigen::VectorXd> eta) const;
  std::vector<Part> PartsAt(const State& at) const;
  void Solve();

  const machine::VolumetricModel& model_;
  const fusion::PopulationEvidence evidence_;
  std::vector<std::string> machines_;
  std::vector<fusion::Quadratic> seen_;
  Eigen::MatrixXd lines_;  // X
  Eigen::VectorXd own_;    // diagonal of D
  Eigen::VectorXd phi_;
  std::vector<Eigen::VectorXd> eta_;
  std::vector<Part> parts_;
  Eigen::MatrixXd information_;  // of phi
  std::vector<fusion::Statement> statements_;
};

}  // namespace abbe::fleet
