// The benchmark arm with Pinocchio. Momentum regressor: forward kinematics, then bodyRegressor of every body, turned
// to the world and shifted to its origin; Pinocchio has no such function, so a user writes this one. Forward dynamics
// by aba, and a simulation under joint torques. Prints name,value,unit.
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/centroidal.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/multibody.hpp>

#include "arm.hpp"

namespace pin = pinocchio;
using Eigen::Vector3d;
using Eigen::VectorXd;

static pin::Model arm() {
  pin::Model model;
  model.gravity.setZero();
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

// Forward dynamics at the ring of states under constant torques, and the simulation: classical Runge-Kutta in the
// quaternion, normalised once a step.
static void dynamics(const pin::Model& model, pin::Data& data, const std::vector<VectorXd>& q,
                     const std::vector<VectorXd>& v) {
  VectorXd tau = VectorXd::Zero(12);
  tau.tail<6>() << 1.0, -0.8, 0.6, 0.1, -0.05, 0.02;
  int at = 0;
  auto call = [&](pin::Convention convention) {
    at = (at + 1) % 64;
    pin::aba(model, data, q[at], v[at], tau, convention);
    asm volatile("" : : "g"(&data.ddq) : "memory");
  };
  if (!std::getenv("PEER_COUNT")) {
    call(pin::Convention::WORLD);
    std::printf("pinocchio_joint_acceleration_at_state_1,%.12e,norm\n", data.ddq.tail<6>().norm());
  }
  measure("pinocchio_forward_dynamics", [&] { call(pin::Convention::WORLD); });
  measure("pinocchio_forward_dynamics_local", [&] { call(pin::Convention::LOCAL); });

  VectorXd y(25), k[4], trial(25);
  auto derivative = [&](double t, const VectorXd& y, VectorXd& dy) {
    for (int j = 0; j < 6; ++j) tau[6 + j] = kTorque[j][0] * std::sin(kTorque[j][1] * t + kTorque[j][2]);
    const VectorXd position = y.head<13>(), velocity = y.tail<12>();
    dy.resize(25);
    dy.tail<12>() = pin::aba(model, data, position, velocity, tau);
    const Eigen::Quaterniond r(position[6], position[3], position[4], position[5]);
    const Eigen::Quaterniond turn = r * Eigen::Quaterniond(0, velocity[3], velocity[4], velocity[5]);
    dy.head<3>() = r.toRotationMatrix() * velocity.head<3>();
    dy.segment<4>(3) = 0.5 * turn.coeffs();
    dy.segment<6>(7) = velocity.tail<6>();
  };
  auto normalise = [](VectorXd& y) { y.segment<4>(3).normalize(); };
  auto step = [&](double t, double h) {
    derivative(t, y, k[0]);
    trial = y + h / 2 * k[0], normalise(trial);
    derivative(t + h / 2, trial, k[1]);
    trial = y + h / 2 * k[1], normalise(trial);
    derivative(t + h / 2, trial, k[2]);
    trial = y + h * k[2], normalise(trial);
    derivative(t + h, trial, k[3]);
    y += h / 6 * (k[0] + 2 * (k[1] + k[2]) + k[3]), normalise(y);
  };
  auto start = [&] {
    y.setZero();
    y[6] = 1;
    for (int j = 0; j < 6; ++j) y[7 + j] = kStart[j], y[13 + j] = kBase[j];
  };
  auto momentum = [&] { return pin::computeCentroidalMomentum(model, data, VectorXd(y.head<13>()), VectorXd(y.tail<12>())); };
  for (double h : {0.01, 0.001}) {
    const std::string name = std::string("pinocchio_sim_rk4_") + (h > 0.005 ? "10ms" : "1ms");
    if (const char* count = std::getenv("PEER_COUNT")) {
      start();
      if (std::strncmp(count, (name + ":").c_str(), name.size() + 1) == 0)
        for (long n = 0; n < std::atol(count + name.size() + 1); ++n) step(n * h, h);
      continue;
    }
    start();
    const pin::Force before = momentum();
    const long steps = std::lround(20 / h);
    double least = 1e9;
    for (int repeat = 0; repeat < 20; ++repeat) {
      start();
      const double from = seconds();
      for (long n = 0; n < steps; ++n) step(n * h, h);
      least = std::min(least, seconds() - from);
    }
    const pin::Force after = momentum();
    double error = 0;
    for (int j = 0; j < 6; ++j) error = std::max(error, std::fabs(y[7 + j] - kEnd[j]));
    std::printf("%s,%.1f,simulated_s_per_s\n%s,%.2e,joint_error_rad\n", name.c_str(), 20 / least, name.c_str(), error);
    std::printf("%s,%.2e,P_drift_N_s\n", name.c_str(), (after.linear() - before.linear()).norm());
    std::printf("%s,%.2e,L_drift_N_m_s\n", name.c_str(), (after.angular() - before.angular()).norm());
  }
}

int main() {
  const pin::Model model = arm();
  pin::Data data(model);
  std::vector<VectorXd> q, v;
  for (const State& s : states()) {
    VectorXd position = VectorXd::Zero(13), velocity = VectorXd::Zero(12);
    position[6] = 1;  // unit quaternion
    for (int j = 0; j < 6; ++j) {
      position[7 + j] = s.q[j];
      velocity[6 + j] = s.rates[j];
      velocity[j] = s.base[j];
    }
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
  VectorXd parameters(70);
  for (int i = 1; i < model.njoints; ++i)
    parameters.segment<10>(10 * (i - 1)) = model.inertias[i].toDynamicParameters();
  if (!std::getenv("PEER_COUNT")) {
    call();
    const VectorXd momentum = Y * parameters;
    std::printf("pinocchio_momentum_at_state_1,%.12e,norm\n", momentum.norm());
  }
  measure("pinocchio_momentum_regressor_6x70", call);
  dynamics(model, data, q, v);
}
