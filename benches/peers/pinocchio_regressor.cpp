// Momentum regressor of the benchmark arm with Pinocchio: forward kinematics, then bodyRegressor of every
// body, turned to the world and shifted to its origin. Pinocchio has no such function, so a user writes this
// one. Prints name,value,unit.
//
// Same arm as crates/poinsot-dynamics/benches/xu_arm, a ring of 64 states, batches of 4096 calls.
// PEER_COUNT=<calls> runs a fixed number of calls instead, for instruction counters.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/multibody.hpp>
#include <string>
#include <vector>

namespace pin = pinocchio;
using Eigen::Vector3d;
using Eigen::VectorXd;

static const double kMass[7] = {400, 12, 10, 10, 8, 6, 30};
static const double kCentre[7][3] = {{0, 0, 0},     {0, 0, .150},    {.270, 0, -.251},  {0, 0, .150},
                                     {0, 0, -.350}, {0, -.034, 0},   {-.270, 0, .430}};
static const double kNext[6][3] = {{.357, -.010, .419}, {0, 0, .150},  {.560, 0, -.049},
                                   {0, 0, .150},        {0, 0, -.700}, {0, -.066, 0}};
// Ixx Iyy Izz Ixy Ixz Iyz about the mass centre.
static const double kInertia[7][6] = {{30, 28, 32, .260, .370, -.290}, {.510, .510, .200, 0, 0, 0},
                                      {.278, 1.811, 1.690, 0, .263, 0}, {.420, .420, .150, 0, 0, 0},
                                      {.500, .500, .210, 0, 0, 0},     {.330, .172, .260, 0, 0, 0},
                                      {2.398, 2.678, 1.405, -.069, .013, .051}};
static const double kRoll[6] = {0, 1, 0, -1, 1, -1};  // quarter turns about x

static pin::Model arm() {
  pin::Model model;
  pin::JointIndex parent = 0;
  for (int i = 0; i < 7; ++i) {
    pin::SE3 placement = pin::SE3::Identity();
    if (i > 0) {
      const Vector3d at = Vector3d(kCentre[i - 1]) + Vector3d(kNext[i - 1]);
      const Eigen::AngleAxisd roll(kRoll[i - 1] * M_PI / 2, Vector3d::UnitX());
      placement = pin::SE3(roll.toRotationMatrix(), at);
    }
    const std::string name = "joint" + std::to_string(i);
    if (i == 0)
      parent = model.addJoint(parent, pin::JointModelFreeFlyer(), placement, name);
    else
      parent = model.addJoint(parent, pin::JointModelRZ(), placement, name);
    const double* e = kInertia[i];
    Eigen::Matrix3d inertia;
    inertia << e[0], e[3], e[4], e[3], e[1], e[5], e[4], e[5], e[2];
    model.appendBodyToJoint(parent, pin::Inertia(kMass[i], Vector3d(kCentre[i]), inertia), pin::SE3::Identity());
  }
  return model;
}

static void momentum_regressor(const pin::Model& model, pin::Data& data, const VectorXd& q, const VectorXd& v,
                               Eigen::MatrixXd& Y) {
  pin::forwardKinematics(model, data, q, v);
  Eigen::Matrix<double, 6, 10> body;
  for (int i = 1; i < model.njoints; ++i) {
    // Regressor of I a + v x* I v at v = 0 and a = the velocity: the momentum of the body in its own axes.
    pin::bodyRegressor(pin::Motion::Zero(), data.v[i], body);
    const Eigen::Matrix3d& R = data.oMi[i].rotation();
    const Vector3d& p = data.oMi[i].translation();
    auto columns = Y.middleCols<10>(10 * (i - 1));
    columns.topRows<3>().noalias() = R * body.topRows<3>();
    columns.bottomRows<3>().noalias() = R * body.bottomRows<3>();
    columns.bottomRows<3>().noalias() += pin::skew(p) * columns.topRows<3>();
  }
}

static double number(unsigned long long& state) {  // splitmix64, -1 to 1
  state += 0x9e3779b97f4a7c15ull;
  unsigned long long z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  z ^= z >> 31;
  return double(z >> 11) * (2.0 / 9007199254740992.0) - 1.0;
}

int main() {
  const pin::Model model = arm();
  pin::Data data(model);
  std::vector<VectorXd> q, v;
  unsigned long long state = 1;
  for (int k = 0; k < 64; ++k) {
    VectorXd position = VectorXd::Zero(13), velocity = VectorXd::Zero(12);
    position[6] = 1;  // unit quaternion
    for (int j = 0; j < 6; ++j) position[7 + j] = 2.0 * number(state);
    for (int j = 0; j < 6; ++j) velocity[6 + j] = 0.5 * number(state);
    for (int j = 0; j < 6; ++j) velocity[j] = 0.1 * number(state);
    q.push_back(position);
    v.push_back(velocity);
  }
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(6, 70);
  int at = 0;
  auto call = [&] {
    at = (at + 1) % 64;
    momentum_regressor(model, data, q[at], v[at], Y);
    asm volatile("" : : "g"(&Y) : "memory");
  };
  if (const char* count = std::getenv("PEER_COUNT")) {
    for (long n = std::atol(count); n > 0; --n) call();
    return 0;
  }
  VectorXd parameters(70);
  for (int i = 1; i < model.njoints; ++i)
    parameters.segment<10>(10 * (i - 1)) = model.inertias[i].toDynamicParameters();
  at = 0;
  call();
  const VectorXd momentum = Y * parameters;
  std::printf("pinocchio_momentum_at_state_1,%.12e,norm\n", momentum.norm());
  const int batches = 400, calls = 4096;
  std::vector<double> times;
  for (int b = 0; b < batches; ++b) {
    const auto start = std::chrono::steady_clock::now();
    for (int n = 0; n < calls; ++n) call();
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
    times.push_back(took.count() / calls);
  }
  std::sort(times.begin(), times.end());
  std::printf("pinocchio_momentum_regressor_6x70,%.1f,ns_min\n", times[0]);
  std::printf("pinocchio_momentum_regressor_6x70,%.1f,ns_median\n", times[batches / 2]);
}
