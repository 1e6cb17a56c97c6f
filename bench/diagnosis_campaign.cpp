// Seconds and memory of the diagnosis of a standard campaign, and by how much the shared projection
// is faster than scoring each candidate by a linear solve of its own. One core, one run.
//
//   bench/diagnosis_campaign [reduced]
//
// The campaign is that of the virtual rig's demonstration mill, as it is measured and, with
// `reduced`, as the statistics use it; seed 1 hides a backlash.
#include <fmt/format.h>
#include <sys/resource.h>

#include <Eigen/Dense>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <vector>

#include "clock.h"
#include "diagnosis/diagnose.h"
#include "estimation/linearization.h"
#include "fusion/machine_problem.h"
#include "machine/machine.h"
#include "probes/head_settings.h"
#include "relm/linkage_settings.h"
#include "rig/campaign.h"
#include "settings/document.h"

namespace {

using namespace abbe;
using bench::Seconds;
using diagnosis::Candidate;
using diagnosis::Score;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Everything that a candidate is scored against, at a fit.
struct Linear {
  std::vector<std::shared_ptr<const simulation::Response>> responses;
  std::vector<MatrixXd> J;  // all columns of the problem
  std::vector<VectorXd> r;
  MatrixXd H;
  VectorXd g;
};

Linear LinearAt(const diagnosis::Campaign& campaign, const diagnosis::Fit& fit) {
  std::vector<simulation::SimulatedRun> runs;
  for (const auto& run : campaign.runs()) runs.push_back(run.simulated);
  machine::VolumetricModel model = campaign.model();
  const estimation::Problem problem =
      fusion::MakeMachineProblem(campaign.instruments().machine, model, campaign.prior(), runs);
  const estimation::Layout layout(problem);
  const VectorXd x = fusion::ValuesFound(fit.result(), fit.result().blocks);
  const auto at = estimation::Linearize(problem, layout, x, 1);
  Linear linear;
  linear.H = at.prior.information;
  linear.g = at.prior.gradient;
  for (const auto& source : at.sources) {
    linear.H += source.information;
    linear.g += source.gradient;
  }
  estimation::RowEvaluator evaluator(problem, layout);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto* rows = evaluator.Evaluate(problem.terms()[i], x, true);
    MatrixXd J = MatrixXd::Zero(rows->r.size(), linear.H.cols());
    J(Eigen::all, rows->columns) = rows->jacobian;
    linear.J.push_back(std::move(J));
    linear.r.push_back(rows->r);
    linear.responses.push_back(
        runs[i].response ? runs[i].response->At(fusion::ValuesFound(fit.result(), runs[i].blocks))
                         : nullptr);
  }
  return linear;
}

// The log evidence of one candidate from the normal equations of everything with it.
double OwnSolve(const diagnosis::Fit& fit, const Linear& linear, const Candidate& candidate) {
  const Index n = linear.H.cols(), k = candidate.cause->coefficients();
  MatrixXd A = MatrixXd::Zero(n + k, n + k);
  VectorXd b = VectorXd::Zero(n + k);
  A.topLeftCorner(n, n) = linear.H;
  b.head(n) = linear.g;
  for (std::size_t i = 0; i < linear.J.size(); ++i) {
    if (!linear.responses[i]) continue;
    const auto acting = candidate.cause->columns(fit.TraceOf(i), candidate.object, candidate.shape);
    if (acting.empty()) continue;
    const MatrixXd C = linear.responses[i]->Columns(acting);
    A.bottomLeftCorner(k, n) += C.transpose() * linear.J[i];
    A.bottomRightCorner(k, k) += C.transpose() * C;
    b.tail(k) += C.transpose() * linear.r[i];
  }
  A.bottomRightCorner(k, k).diagonal() += candidate.cause->plausible.cwiseAbs2().cwiseInverse();
  const VectorXd scale = A.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<MatrixXd> factor(MatrixXd(
      scale.asDiagonal() * A.selfadjointView<Eigen::Lower>().toDenseMatrix() * scale.asDiagonal()));
  const VectorXd c = scale.cwiseProduct(factor.solve(VectorXd(scale.cwiseProduct(b)))).tail(k);
  return c.norm();
}

}  // namespace

int main(int argc, char** argv) {
  const bool reduced = argc > 1 && std::string_view(argv[1]) == "reduced";
  const auto document =
      settings::Document::Read(std::filesystem::path(ABBE_SOURCE_DIR) / "machines/demo_mill.toml");
  auto machine = rig::ReadCampaignMachine(document.Root());
  machine.rig.cap = 0.0;  // a cause of its own
  const auto world = rig::RecordCampaign(
      machine, 1, {rig::ParseHidden("backlash:object=X:width_um=4", 1, machine.sensors)},
      {.kind = rig::CampaignKind::kStandard, .reduced = reduced});
  double rows = 0.0;
  for (const auto& recording : world.recordings) rows += static_cast<double>(recording.rows());

  const double start = Seconds();
  diagnosis::Campaign campaign(
      {machine::ReadMachine(document.Root()), probes::ReadHeadSettings(document.Root()),
       probes::ReadTargetSettings(document.Root()), probes::ReadProbeNoise(document.Root()),
       relm::ReadLinkageSettings(document.Root())});
  campaign.Add(world.recordings);
  const double read = Seconds();
  const auto found = diagnosis::Diagnose(campaign);
  const double done = Seconds();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print(
      "{:.0f} rows: read {:.1f} s, diagnosed {:.1f} s, {:.0f} MB; {}\n", rows, read - start,
      done - read, usage.ru_maxrss / 1024.0,
      found.findings.empty() ? "nothing found" : found.findings.front().score.candidate.Name());

  const diagnosis::Fit fit(campaign);
  std::vector<Candidate> candidates;
  for (const Candidate& each : diagnosis::AllCandidates(campaign.scene())) {
    if (each.cause->columns && !each.cause->relaxes) candidates.push_back(each);
  }
  const double before = Seconds();
  const auto scores = diagnosis::ScoreAll(fit, candidates);
  const double shared = (Seconds() - before) / static_cast<double>(candidates.size());
  const Linear linear = LinearAt(campaign, fit);
  constexpr std::size_t kEvery = 40;
  double worst = 0.0;
  std::size_t solved = 0;
  const double own_before = Seconds();
  for (std::size_t i = 0; i < candidates.size(); i += kEvery) {
    const double size = scores[i].coefficients.norm();
    if (candidates[i].cause->IsBinary() || size == 0.0) continue;
    ++solved;
    worst = std::max(worst, std::abs(OwnSolve(fit, linear, candidates[i]) - size) / size);
  }
  const double own = (Seconds() - own_before) / static_cast<double>(solved);
  fmt::print(
      "{} candidates: {:.2f} ms each together, {:.2f} ms each alone: {:.1f} times; coefficients "
      "the same within {:.1g}\n",
      candidates.size(), 1e3 * shared, 1e3 * own, own / shared, worst);
  return 0;
}
