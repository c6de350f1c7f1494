// The benchmark arm with MuJoCo: forward dynamics at the ring of states under constant torques, and a simulation under
// joint torques by its own Runge-Kutta. Nothing that costs time and is not asked for is left on. Prints
// name,value,unit.
#include <mujoco/mujoco.h>

#include "arm.hpp"

static std::string xml() {
  std::string text =
      "<mujoco><compiler angle='radian' balanceinertia='false'/><option gravity='0 0 0' integrator='RK4'/><worldbody>";
  char line[1024];
  for (int i = 0; i < 7; ++i) {
    double at[3] = {0, 0, 0};
    if (i > 0)
      for (int k = 0; k < 3; ++k) at[k] = kCentre[i - 1][k] + kNext[i - 1][k];
    const double half = i > 0 ? kRoll[i - 1] * M_PI / 4 : 0;
    const double *c = kCentre[i], *e = kInertia[i];
    std::snprintf(line, sizeof line, "<body pos='%.17g %.17g %.17g' quat='%.17g %.17g 0 0'>%s", at[0], at[1], at[2],
                  std::cos(half), std::sin(half), i > 0 ? "<joint type='hinge' axis='0 0 1'" : "<freejoint/>");
    text += line;
    if (i > 0) text += " name='j" + std::to_string(i) + "'/>";
    std::snprintf(line, sizeof line,
                  "<inertial pos='%.17g %.17g %.17g' mass='%.17g' fullinertia='%.17g %.17g %.17g %.17g %.17g %.17g'/>",
                  c[0], c[1], c[2], kMass[i], e[0], e[1], e[2], e[3], e[4], e[5]);
    text += line;
  }
  for (int i = 0; i < 7; ++i) text += "</body>";
  text += "</worldbody><actuator>";
  for (int i = 1; i < 7; ++i) text += "<motor joint='j" + std::to_string(i) + "'/>";
  return text + "</actuator></mujoco>";
}

static void torques(const mjModel*, mjData* data) {
  for (int j = 0; j < 6; ++j)
    data->ctrl[j] = kTorque[j][0] * std::sin(kTorque[j][1] * data->time + kTorque[j][2]);
}

static void start(const mjModel* model, mjData* data) {
  mj_resetData(model, data);
  data->qpos[3] = 1;
  for (int j = 0; j < 6; ++j) data->qpos[7 + j] = kStart[j], data->qvel[j] = kBase[j];
}

// Linear momentum, and angular momentum about the mass centre.
static void momentum(const mjModel* model, mjData* data, double* x) {
  mj_kinematics(model, data);
  mj_comPos(model, data);
  mj_comVel(model, data);
  mj_subtreeVel(model, data);
  for (int k = 0; k < 3; ++k) {
    x[k] = data->subtree_linvel[3 + k] * model->body_subtreemass[1];
    x[3 + k] = data->subtree_angmom[3 + k];
  }
}

static double apart(const double* a, const double* b) {
  return std::sqrt(std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2));
}

int main() {
  char error[1000] = "";
  mjSpec* spec = mj_parseXMLString(xml().c_str(), nullptr, error, sizeof error);
  mjModel* model = spec ? mj_compile(spec, nullptr) : nullptr;
  if (!model) return std::fprintf(stderr, "%s\n", error), 1;
  model->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_CONSTRAINT | mjDSBL_GRAVITY | mjDSBL_SENSOR | mjDSBL_SPRING |
                             mjDSBL_DAMPER | mjDSBL_WARMSTART;
  mjData* data = mj_makeData(model);
  mj_resetData(model, data);
  const std::vector<State> ring = states();
  const double given[6] = {1.0, -0.8, 0.6, 0.1, -0.05, 0.02};
  int at = 0;
  auto call = [&] {
    at = (at + 1) % 64;
    const State& s = ring[at];
    data->qpos[3] = 1;
    for (int j = 0; j < 6; ++j) {
      data->qpos[7 + j] = s.q[j];
      data->qvel[6 + j] = s.rates[j];
      data->qvel[j] = s.base[j];
      data->ctrl[j] = given[j];
    }
    mj_forward(model, data);
    asm volatile("" : : "g"(data->qacc) : "memory");
  };
  if (!std::getenv("PEER_COUNT")) {
    call();
    double sum = 0;
    for (int j = 0; j < 6; ++j) sum += data->qacc[6 + j] * data->qacc[6 + j];
    std::printf("mujoco_joint_acceleration_at_state_1,%.12e,norm\n", std::sqrt(sum));
  }
  measure("mujoco_forward_dynamics", call);
  mjcb_control = torques;
  for (double h : {0.01, 0.001}) {
    model->opt.timestep = h;
    const std::string name = std::string("mujoco_sim_rk4_") + (h > 0.005 ? "10ms" : "1ms");
    if (const char* count = std::getenv("PEER_COUNT")) {
      start(model, data);
      if (std::strncmp(count, (name + ":").c_str(), name.size() + 1) == 0)
        for (long n = std::atol(count + name.size() + 1); n > 0; --n) mj_step(model, data);
      continue;
    }
    double before[6], after[6], least = 1e9, worst = 0;
    start(model, data);
    momentum(model, data, before);
    const long steps = std::lround(20 / h);
    for (int repeat = 0; repeat < 20; ++repeat) {
      start(model, data);
      const double from = seconds();
      for (long n = 0; n < steps; ++n) mj_step(model, data);
      least = std::min(least, seconds() - from);
    }
    momentum(model, data, after);
    for (int j = 0; j < 6; ++j) worst = std::max(worst, std::fabs(data->qpos[7 + j] - kEnd[j]));
    std::printf("%s,%.1f,simulated_s_per_s\n%s,%.2e,joint_error_rad\n", name.c_str(), 20 / least, name.c_str(), worst);
    std::printf("%s,%.2e,P_drift_N_s\n%s,%.2e,L_drift_N_m_s\n", name.c_str(), apart(after, before), name.c_str(),
                apart(after + 3, before + 3));
  }
}
